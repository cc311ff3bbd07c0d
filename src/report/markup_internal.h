/* SPDX-License-Identifier: Apache-2.0 */
/* Text of the caller inside HTML and SVG. */
#ifndef IMUKIT_REPORT_MARKUP_INTERNAL_H
#define IMUKIT_REPORT_MARKUP_INTERNAL_H

#include "growing_text_internal.h"

/* Escape all markup in a text; control characters are left out, because neither language allows
 * them. NULL is "". */
void imki_markup_escape(imki_text *out, const char *text);

#endif
