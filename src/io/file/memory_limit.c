/* SPDX-License-Identifier: Apache-2.0 */
/* Memory of the machine and the limits on it. Containers see the machine's memory and are ended
 * when they take more than that of their control group, which Linux tells in a file. */
#define _DEFAULT_SOURCE /* _SC_PHYS_PAGES */
#include "imukit/memory_limit.h"

#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

static size_t lower_of(size_t limit, double other)
{
    return other >= 1.0 && other < (double)limit ? (size_t)other : limit;
}

static size_t machine_memory(void)
{
#ifdef _SC_PHYS_PAGES
    return lower_of(SIZE_MAX, (double)sysconf(_SC_PHYS_PAGES) * (double)sysconf(_SC_PAGESIZE));
#else
    return SIZE_MAX;
#endif
}

/* The number in a file; 0 when there is none ("max": no limit). */
static double number_in(const char *path)
{
    double number = 0.0;
    FILE *file = fopen(path, "r");
    if (!file)
        return 0.0;
    if (fscanf(file, "%lf", &number) != 1)
        number = 0.0;
    fclose(file);
    return number;
}

/* The limit of the control group the process is in: version 2 names it, version 1 has one place. */
static size_t group_memory(size_t limit)
{
    char line[512], path[600];
    FILE *file = fopen("/proc/self/cgroup", "r");
    limit = lower_of(limit, number_in("/sys/fs/cgroup/memory.max"));
    limit = lower_of(limit, number_in("/sys/fs/cgroup/memory/memory.limit_in_bytes"));
    while (file && fgets(line, sizeof line, file)) {
        line[strcspn(line, "\n")] = '\0';
        if (strncmp(line, "0::", 3) != 0)
            continue;
        snprintf(path, sizeof path, "/sys/fs/cgroup%s/memory.max", line + 3);
        limit = lower_of(limit, number_in(path));
    }
    if (file)
        fclose(file);
    return limit;
}

size_t imk_memory_limit(void)
{
    static const int resources[] = {RLIMIT_AS, RLIMIT_DATA};
    size_t limit = group_memory(machine_memory());
    for (size_t i = 0; i < sizeof resources / sizeof resources[0]; i++) {
        struct rlimit allowed;
        if (getrlimit(resources[i], &allowed) == 0 && allowed.rlim_cur != RLIM_INFINITY)
            limit = lower_of(limit, (double)allowed.rlim_cur);
    }
    return limit;
}
