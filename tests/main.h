/* SPDX-License-Identifier: Apache-2.0 */
/* Included before every test file by the build, which compiles its main under the file's name. The
 * cases go to main.c, which runs those that are asked for. */
#ifndef IMUKIT_TESTS_MAIN_H
#define IMUKIT_TESTS_MAIN_H

#define _cmocka_run_group_tests run_asked_for

int main(void);

#endif
