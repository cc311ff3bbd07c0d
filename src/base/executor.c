/* SPDX-License-Identifier: Apache-2.0 */
/* Running work items on the caller's threads, or in order when it lends none. */
#include "imukit/executor.h"

void imk_execute(const imk_executor *executor, size_t count, imk_work work, void *work_context)
{
    if (executor && executor->run) {
        executor->run(executor->context, count, work, work_context);
        return;
    }
    for (size_t item = 0; item < count; item++)
        work(work_context, item);
}
