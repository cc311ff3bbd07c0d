/* SPDX-License-Identifier: Apache-2.0 */
/* imukit_gateway(VERB, …): runs a verb of the command and returns what it found as a struct. The
 * functions imukit_allan() and so on call it. */
#include "gateway.h"

#include "shell/command.h"

#include <string.h>

static const verb *const verbs[] = {&allan_verb, &identify_verb, &simulate_verb, &calibrate_verb,
                                    &drift_verb};
enum { VERBS = sizeof verbs / sizeof verbs[0] };

static bool find_verb(const mxArray *name)
{
    gateway_call *call = gateway_now();
    const char *text = gateway_text(name);
    for (size_t i = 0; text && i < VERBS; i++)
        if (strcmp(verbs[i]->name, text) == 0)
            call->verb = verbs[i];
    return call->verb || gateway_refuse("the first argument is the name of a verb: allan, "
                                        "identify, simulate, calibrate or drift");
}

static void run_verb(void)
{
    gateway_call *call = gateway_now();
    command_begin(call->verb->name);
    command_line_keep(call->count, call->word);
    const int code = call->verb->run(call->count - 2, call->word + 2);
    command_line_keep(0, NULL);
    if (!call->json)
        (void)gateway_refuse("imukit %s ended with exit code %d", call->verb->name, code);
    for (size_t i = 0; i < call->warning_count; i++)
        gateway_without_folder(call->warning[i].text);
    gateway_without_folder(call->failure);
    if (call->json)
        gateway_without_folder(call->json);
    if (call->model)
        gateway_without_folder(call->model);
}

/* Where a failure leaves. */
static void end_failed(void)
{
    const gateway_call *call = gateway_now();
    char id[64], text[GATEWAY_TEXT_SIZE + 80];
    snprintf(id, sizeof id, "imukit:%s", call->failed_by);
    const bool full = call->log_due && strcmp(call->failed_by, "write") == 0;
    snprintf(text, sizeof text, "%s%s", call->failure,
             full ? "; the log is a temporary file in the folder that TMPDIR names" : "");
    gateway_clear();
    mexErrMsgIdAndTxt(id, "%s", text);
}

static void warn(void)
{
    const gateway_call *call = gateway_now();
    for (size_t i = 0; i < call->warning_count; i++) {
        char id[64];
        snprintf(id, sizeof id, "imukit:%s", call->warning[i].code);
        mexWarnMsgIdAndTxt(id, "%s", call->warning[i].text);
    }
}

static void set(mxArray *result, const char *name, mxArray *value)
{
    mxSetFieldByNumber(result, 0, mxAddField(result, name), value);
}

void mexFunction(int nlhs, mxArray *plhs[], int nrhs, const mxArray *prhs[])
{
    gateway_call *call = gateway_now();
    mxArray *columns = NULL, *data = NULL, *result;
    gateway_clear();
    mexAtExit(gateway_clear); /* also where the person left by Ctrl-C */
    if (nlhs > 1)
        (void)gateway_refuse("there is one result");
    else if (nrhs < 1)
        (void)gateway_refuse("the name of a verb is missing");
    else if (find_verb(prhs[0]) && gateway_take(nrhs - 1, prhs + 1))
        run_verb();
    if (!call->failed_by[0] && call->log_due)
        (void)gateway_read_log(&columns, &data);
    gateway_remove_files();
    if (call->failed_by[0])
        end_failed();
    warn();
    result = gateway_value(call->json);
    if (columns) {
        set(result, "columns", columns);
        set(result, "data", data);
    }
    if (call->model)
        set(result, "model", mxCreateString(call->model));
    plhs[0] = result;
    gateway_clear();
}
