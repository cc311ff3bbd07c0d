/* SPDX-License-Identifier: Apache-2.0 */
/* Aids of a navigator in options. */
#include "aid_option.h"

#include "imukit/aid_text.h"
#include "imukit/io.h"

#include <math.h>
#include <string.h>

int aid_option_parse(const char *name, const char *text, size_t *count, imk_aid *aids)
{
    imk_error error;
    if (imk_aid_parse(text, aids, count, &error) == IMK_OK)
        return -1;
    char words[700];
    error.field[0] = '\0';
    imk_error_text(&error, NULL, words, sizeof words);
    return command_misused("--%s \"%s\": %s", name, text, words);
}

int aid_option_kinds(const char *name, const char *text, size_t *count, imk_aid *aids)
{
    const int code = aid_option_parse(name, text, count, aids);
    if (code >= 0)
        return code;
    for (size_t k = 1; k < *count; k++)
        for (size_t j = 0; j < k; j++)
            if (aids[j].kind == aids[k].kind)
                return command_misused("--%s \"%s\": the %s is stated twice", name, text,
                                       imk_aid_kind_name(aids[k].kind));
    return -1;
}

int aid_option_arm(const char *name, const char *text, double arm[3], double *sigma)
{
    double sigmas[3] = {0};
    size_t count = 0;
    imk_error error;
    if (imk_quantity_parse(text, text + strlen(text), imk_unit_of("m").dimension, 3, arm, sigmas,
                           &count, NULL, &error) != IMK_OK ||
        count != 3)
        return command_misused("--%s \"%s\": expected three lengths, forward, right and down from "
                               "the unit, such as \"0.2 -0.5 -1.1 m\"%s",
                               name, text, sigma ? ", with their 1 sigma after +- if known" : "");
    for (int i = 0; i < 3; i++) {
        if (!(fabs(arm[i]) <= 1e6))
            return command_misused("--%s \"%s\": not a length on a vehicle", name, text);
        if (sigma)
            sigma[i] = sigmas[i];
        else if (sigmas[i] > 0.0)
            return command_misused("--%s \"%s\" takes no uncertainty; leave out its +-", name,
                                   text);
    }
    return -1;
}
