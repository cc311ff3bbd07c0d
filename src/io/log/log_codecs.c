/* SPDX-License-Identifier: Apache-2.0 */
/* The functions of all formats of logs, in the order of their rows. */
#include "log_formats_internal.h"

#define ROW(functions, ...) &imki_log_##functions,
static const imki_log_codec *const codecs[] = {IMKI_LOG_FORMATS(ROW)};
#undef ROW

const imki_log_codec *imki_log_codec_of(const imk_log_format *format)
{
    return codecs[format - imk_log_format_get(0)];
}
