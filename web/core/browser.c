/* SPDX-License-Identifier: Apache-2.0 */
/* The command in a page: `run` is what main() is elsewhere. Each run has a module instance of its
 * own, so what a verb leaves behind ends with it. */
#include "shell/command.h"

/** Do what a line says, as a terminal would: argv[0] is the name of the command.
 *  @return the exit code */
__attribute__((export_name("run"))) int run(int argc, char **argv)
{
    return command_obey(argc, argv);
}
