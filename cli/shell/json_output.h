/* SPDX-License-Identifier: Apache-2.0 */
/* The JSON every reporting verb prints with --json:
 *   {imukit, command, inputs, result, warnings: [{code, message}]}
 * with SI numbers and the unit beside each. */
#ifndef IMUKIT_JSON_OUTPUT_H
#define IMUKIT_JSON_OUTPUT_H

#include "command.h"

#include <jansson.h>

/* Before the first JSON: from here on the command ends where memory fails, so that nobody need look
 * whether a member has been added. */
void json_begin(void);

/* A number, or null when it is not finite. */
json_t *json_number(double value);
/* A text that was given, or read: what is no UTF-8 in it becomes U+FFFD. */
json_t *json_text(const char *text);
/* {"value": …, "unit": …} */
json_t *json_quantity(double value, const char *unit);

/* Print the document to standard output; takes over `inputs` and `result`.
 * @return the exit code: `code`, or EXIT_FAILED when it cannot be written */
int json_print(const char *command, json_t *inputs, json_t *result, int code);

#endif
