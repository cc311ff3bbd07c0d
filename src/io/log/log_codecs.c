/* SPDX-License-Identifier: Apache-2.0 */
/* The functions of all formats of logs, in the order of their rows, and which of them a file is
 * for.
 */
#include "log_formats_internal.h"

#define ROW(functions, ...) &imki_log_##functions,
static const imki_log_codec *const codecs[] = {IMKI_LOG_FORMATS(ROW)};
#undef ROW

const imki_log_codec *imki_log_codec_of(const imk_log_format *format)
{
    return codecs[format - imk_log_format_get(0)];
}

enum { FORMATS = sizeof codecs / sizeof codecs[0] };

const imk_log_format *imki_log_format_of_folders(void)
{
    for (size_t i = 0; i < FORMATS; i++)
        if (codecs[i]->folders)
            return imk_log_format_get(i);
    return NULL;
}

/* The content decides. An ending does only for formats whose files do not tell what they are. */
const imk_log_format *imki_log_recognise(const char *path, const char *begin, size_t size)
{
    const imk_log_format *begun = imk_log_format_begun(begin, size);
    for (size_t i = 1; i < FORMATS && !begun; i++)
        if (codecs[i]->recognise && codecs[i]->recognise(begin, size))
            begun = imk_log_format_get(i);
    const imk_log_format *named = imk_log_format_of(path);
    const bool tells = named->beginning || imki_log_codec_of(named)->recognise;
    return begun ? begun : tells ? imk_log_format_get(0) : named;
}
