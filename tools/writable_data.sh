#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Prints the sections of writable data of object files or archives; succeeds when there are any.
# Constants that hold addresses (.data.rel.ro) are made read-only by the loader and do not count.
#
#     tools/writable_data.sh OBJDUMP FILE...
objdump=$1
shift
"$objdump" -h "$@" | awk '
    /file format/ { file = $1 }
    $2 ~ /^\.(t?data|t?bss|sdata|sbss)(\.|$)/ && $2 !~ /^\.data\.rel\.ro/ && $3 !~ /^0+$/ {
        print file, $2, "0x" $3, "bytes"
        found = 1
    }
    END { exit !found }'
