/* SPDX-License-Identifier: Apache-2.0 */
/* --want "CEP 1 nmi @ 1h", --want "CEP 5 m after 60 s": a figure, how large it may be, and when. */
#include "drift_parts.h"

int drift_want_parse(const char *text, imk_drift_wanted *want, bool *after)
{
    imk_error error;
    if (imk_drift_wanted_parse(text, want, after, &error) == IMK_OK)
        return -1;
    const bool found = error.found[0], expected = error.expected[0];
    return command_misused("--want \"%s\": %s%s%s%s; write --want \"CEP 1 nmi @ 1h\"", text,
                           error.found, found && expected ? "; " : "", expected ? "expected " : "",
                           error.expected);
}
