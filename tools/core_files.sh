#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# Prints the files of libimukit: all modules left of io.
set -eu
cd "$(dirname "$0")/.."
find src/{base,model,noise,motion,simulate,identify,physics,compensate,calibrate,navigate} -name '*.c' | sort
