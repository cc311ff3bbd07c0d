/* SPDX-License-Identifier: Apache-2.0 */
/* Do the instruments refuse in words what cannot be built, and run, reduce and sweep what can?
 *
 * usage: designs [designs] [seed] [instrument] [few|all] [number]
 *
 * Makes so many designs of each instrument (or of one) by moving up to three parameters by up to
 * three decades ("few"), and so many by moving all by up to 40 % ("all"). Each is tried in a
 * process of its own, which ends after 30 s. With a number, the design file of that one is printed.
 * More are made where fewer than 60 % are accepted. Fails if a process ended by a signal, if a
 * refusal has no words, if a number is not finite, if a design took longer than 10 s, or if a
 * figure differs from its closed form and no further experiment tells why. */
#include "random_designs.h"

#include "imukit/design_file.h"

#include <signal.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

enum { REASONS_MAX = 200, LISTED = 25, SLOWEST_ALLOWED = 10, ENDS_AFTER = 30 };
#define ACCEPTED 0.6 /* of the designs, at least */
static const double steps_allowed = 1e7;

typedef struct reason {
    char text[600];
    int count, first;
} reason;

typedef struct summary {
    int ends[DESIGN_ENDS], attempts[DESIGN_ATTEMPTS], sayings[SAYINGS], unmeasured, differs, slow;
    char list[LISTED * 12];
    double slowest;
    int slowest_number;
    reason reasons[REASONS_MAX];
    int reason_count;
    double worst[IMK_LABORATORY_FIGURES_MAX];
    int worst_number[IMK_LABORATORY_FIGURES_MAX], differing[IMK_LABORATORY_FIGURES_MAX];
} summary;

static void add_reason(summary *s, const char *text, int number)
{
    int i = 0;
    while (i < s->reason_count && strcmp(s->reasons[i].text, text) != 0)
        i++;
    if (i == REASONS_MAX)
        return;
    if (i == s->reason_count) {
        snprintf(s->reasons[i].text, sizeof s->reasons[i].text, "%s", text);
        s->reasons[s->reason_count++].first = number;
    }
    s->reasons[i].count++;
}

/* In a process of its own. */
static void try_apart(const imk_instrument *instrument, const void *design, design_outcome *outcome)
{
    int ends[2], status = 0;
    fflush(stdout);
    memset(outcome, 0, sizeof *outcome);
    if (pipe(ends) != 0)
        abort();
    const pid_t child = fork();
    if (child == 0) {
        alarm(ENDS_AFTER);
        try_design(instrument, design, steps_allowed, outcome);
        _exit(write(ends[1], outcome, sizeof *outcome) == (ssize_t)sizeof *outcome ? 0 : 1);
    }
    close(ends[1]);
    const bool whole = read(ends[0], outcome, sizeof *outcome) == (ssize_t)sizeof *outcome;
    close(ends[0]);
    waitpid(child, &status, 0);
    if (whole)
        return;
    memset(outcome, 0, sizeof *outcome);
    outcome->end = DESIGN_WRONG;
    snprintf(outcome->wrong, sizeof outcome->wrong, "ended by signal %d%s", WTERMSIG(status),
             WTERMSIG(status) == SIGALRM ? ", after 30 s" : "");
}

static void add_figures(summary *s, const imk_laboratory_figure *figure, int number,
                        const design_outcome *o)
{
    s->unmeasured += o->unmeasured > 0;
    if (!o->differs) {
        s->attempts[o->attempt]++;
        return;
    }
    s->sayings[o->says]++;
    if (o->says != SAYS_NOTHING)
        return;
    s->differs++;
    if (s->differs <= LISTED)
        snprintf(s->list + strlen(s->list), sizeof s->list - strlen(s->list), " %d", number);
    for (size_t i = 0; i < o->figures; i++) {
        if (!figure_differs(o, i, figure[i].key))
            continue;
        const double z = fabs(o->found[i] - o->computed[i]) / o->sigma[i];
        s->differing[i]++;
        if (z > s->worst[i] || s->differing[i] == 1) {
            s->worst[i] = z;
            s->worst_number[i] = number;
        }
    }
}

static double seconds_now(void)
{
    struct timespec now;
    timespec_get(&now, TIME_UTC);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static void add(summary *s, const imk_laboratory_figure *figure, int number, double seconds,
                const design_outcome *o)
{
    char text[600];
    s->ends[o->end]++;
    if (seconds > s->slowest) {
        s->slowest = seconds;
        s->slowest_number = number;
    }
    s->slow += seconds > SLOWEST_ALLOWED;
    if (o->end == DESIGN_WRONG)
        snprintf(text, sizeof text, "WRONG %s", o->wrong);
    else if (o->end == DESIGN_REFUSED || o->end == DESIGN_UNFIT)
        snprintf(text, sizeof text, "%s %s: %.400s", o->end == DESIGN_REFUSED ? "refused" : "unfit",
                 o->error.field, o->error.expected);
    else if (o->end == DESIGN_RAN)
        snprintf(text, sizeof text, "not swept: the experiments take more than %g steps",
                 steps_allowed);
    else
        text[0] = '\0';
    if (text[0])
        add_reason(s, text, number);
    if (o->end == DESIGN_SWEPT)
        add_figures(s, figure, number, o);
}

static void show(const summary *s, const imk_laboratory_figure *figure, size_t figures)
{
    printf("accepted %d (swept %d, %d of them with a figure that differs), refused %d, "
           "wrong %d; slowest %.2f s (number %d)\n",
           s->ends[DESIGN_RAN] + s->ends[DESIGN_SWEPT] + s->ends[DESIGN_UNFIT],
           s->ends[DESIGN_SWEPT], s->differs, s->ends[DESIGN_REFUSED], s->ends[DESIGN_WRONG],
           s->slowest, s->slowest_number);
    if (s->differs > 0)
        printf("  differing designs:%s%s\n", s->list, s->differs > LISTED ? " ..." : "");
    for (int i = 0; i < s->reason_count; i++)
        printf("  %4d  %s (number %d)\n", s->reasons[i].count, s->reasons[i].text,
               s->reasons[i].first);
    for (int i = 0; i < DESIGN_ATTEMPTS; i++)
        if (s->attempts[i] > 0)
            printf("  %4d  %s\n", s->attempts[i], design_attempts[i].reason);
    for (int i = SAYS_NOTHING + 1; i < SAYINGS; i++)
        if (s->sayings[i] > 0)
            printf("  %4d  %s\n", s->sayings[i], design_sayings[i]);
    if (s->unmeasured > 0)
        printf("  %4d  a figure of the sweep is not a number\n", s->unmeasured);
    for (size_t i = 0; i < figures; i++)
        if (s->differing[i] > 0)
            printf("  %4d  differs: %s, up to %.3g sigma (number %d)\n", s->differing[i],
                   figure[i].key, s->worst[i], s->worst_number[i]);
}

/* @return are they all as they should be? */
static bool try_designs(const imk_instrument *instrument, int move, int designs, uint64_t seed)
{
    imk_laboratory_figure figure[IMK_LABORATORY_FIGURES_MAX];
    summary *s = calloc(1, sizeof *s);
    imk_model *model = malloc(sizeof *model);
    void *design = malloc(instrument->design_size);
    if (!s || !model || !design)
        abort();
    imk_model_default(model);
    const size_t figures = imk_laboratory_figures(model, instrument->sensor, figure);
    printf("%s, %s: ", instrument->name, move_names[move]);
    const int enough = (int)(ACCEPTED * designs);
    int number = 0;
    for (; number < designs || (number < 4 * designs && number - s->ends[DESIGN_REFUSED] < enough);
         number++) {
        design_outcome outcome;
        random_design(instrument, move, number, seed, design);
        const double begin = seconds_now();
        try_apart(instrument, design, &outcome);
        add(s, figure, number, seconds_now() - begin, &outcome);
    }
    show(s, figure, figures);
    const bool right = s->ends[DESIGN_WRONG] == 0 && s->slow == 0 && s->differs == 0 &&
                       number - s->ends[DESIGN_REFUSED] >= enough;
    free(design);
    free(model);
    free(s);
    return right;
}

static void show_difference(const imk_instrument *instrument, const design_outcome *o)
{
    imk_laboratory_figure figure[IMK_LABORATORY_FIGURES_MAX];
    imk_model *model = malloc(sizeof *model);
    if (!model)
        abort();
    imk_model_default(model);
    (void)imk_laboratory_figures(model, instrument->sensor, figure);
    printf("# ends as %d %s%s %s; a sweep takes %g steps, full scale %g, scatter %g\n", o->end,
           o->wrong, o->error.field, o->error.expected, o->sweep_steps, o->full_scale, o->scatter);
    for (size_t i = 0; i < o->figures; i++)
        printf("# %-28s closed form %12.5g, found %12.5g, sigma %9.2g %s%s\n", figure[i].key,
               o->computed[i], o->found[i], o->sigma[i], figure[i].si,
               figure_differs(o, i, figure[i].key) ? " differs" : "");
    free(model);
}

/* The design file of one, and behind it what became of it. */
static int show_one(const imk_instrument *instrument, int move, int number, uint64_t seed)
{
    void *design = malloc(instrument->design_size);
    char *text = NULL;
    size_t size = 0;
    imk_error error = {0};
    design_outcome outcome;
    if (!design)
        abort();
    random_design(instrument, move, number, seed, design);
    const imk_design_file file = {.instrument = instrument, .design = design};
    if (imk_design_print(&file, &text, &size, &error) == IMK_OK)
        fwrite(text, 1, size, stdout);
    else
        printf("# refused: %s: %g, limit %g, %s\n", error.field, error.value, error.limit,
               error.expected);
    try_apart(instrument, design, &outcome);
    show_difference(instrument, &outcome);
    free(text);
    free(design);
    return 0;
}

int main(int argc, char **argv)
{
    const int designs = argc > 1 ? atoi(argv[1]) : 500;
    const uint64_t seed = argc > 2 ? strtoull(argv[2], NULL, 10) : 1;
    const imk_instrument *only = argc > 3 ? imk_instrument_find(argv[3]) : NULL;
    const int move = argc > 4 ? strcmp(argv[4], "all") == 0 ? MOVE_ALL : MOVE_FEW : -1;
    bool right = true;
    if (argc > 3 && !only) {
        fprintf(stderr, "designs: there is no instrument \"%s\"\n", argv[3]);
        return 2;
    }
    if (argc > 5)
        return show_one(only, move, atoi(argv[5]), seed);
    for (size_t n = 0; n < imk_instrument_count(); n++)
        for (int m = 0; m < MOVES; m++)
            if ((!only || only == imk_instrument_get(n)) && (move < 0 || move == m))
                right = try_designs(imk_instrument_get(n), m, designs, seed) && right;
    return right ? 0 : 1;
}
