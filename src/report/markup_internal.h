/* SPDX-License-Identifier: Apache-2.0 */
/* Text of the caller inside HTML, SVG and JSON. */
#ifndef IMUKIT_REPORT_MARKUP_INTERNAL_H
#define IMUKIT_REPORT_MARKUP_INTERNAL_H

#include "growing_text_internal.h"

/* Escape all markup in a text; control characters are left out, because neither language allows
 * them. NULL is "". */
void imki_markup_escape(imki_text *out, const char *text);

/* A text as a string of JSON [RFC8259], in quotes. */
void imki_markup_quote(imki_text *out, const char *text);

/* JSON as the content of a <script>, which no text in it can end; what is not UTF-8 is replaced. */
void imki_markup_data(imki_text *out, const char *json);

#endif
