/* SPDX-License-Identifier: Apache-2.0 */
/* Included before every test file by the build, which compiles its main under the file's name. */
#ifndef IMUKIT_TESTS_MAIN_H
#define IMUKIT_TESTS_MAIN_H

int main(void);

#endif
