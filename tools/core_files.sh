#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# Prints the files of libimukit and libimukit-physics: all modules left of jobs.
set -eu
cd "$(dirname "$0")/.."
find src/{base,model,noise,motion,simulate,identify,compensate,calibrate,navigate,physics} -name '*.c' | sort
