/* SPDX-License-Identifier: Apache-2.0 */
/* The verbs: finds the one that is named and hands it the rest of the line; help. */
#define _POSIX_C_SOURCE 200809L
#include "command.h"

#include <string.h>

#define VERB(name) &name##_verb,
static const verb *const verbs[] = {COMMAND_VERBS(VERB)};
#undef VERB
enum { VERB_COUNT = sizeof verbs / sizeof verbs[0] };

void command_welcome(FILE *out)
{
    const char *bold = command_color(out, COLOR_BOLD), *reset = command_color(out, COLOR_RESET);
    fprintf(
        out,
        "imukit %s: find, simulate and correct the errors of gyros and accelerometers\n\n%sFirst "
        "result%s (no sensor needed)\n  imukit simulate AHRS --rate 100Hz --duration 1h --seed 1 "
        "-o static.csv\n  imukit identify static.csv -o model.yaml --report report.html\n\n%sWith "
        "your own sensor%s: leave it at rest for an hour or more, log it, and run\n  imukit "
        "identify LOG.csv -o model.yaml --report report.html\nThe message names the option to add "
        "if the units or the rate are not in the file.\n\n%sVerbs%s\n",
        imk_version(), bold, reset, bold, reset, bold, reset);
    for (size_t i = 0; i < VERB_COUNT; i++)
        fprintf(out, "  %-10s %s\n", verbs[i]->name, verbs[i]->summary);
    fprintf(out, "\n  imukit VERB --help   examples and options of a verb\n"
                 "  imukit --version\n");
}

static const verb *find_verb(const char *name)
{
    for (size_t i = 0; i < VERB_COUNT; i++)
        if (strcmp(verbs[i]->name, name) == 0)
            return verbs[i];
    return NULL;
}

static int unknown_verb(const char *name)
{
    const char *names[VERB_COUNT + 1];
    for (size_t i = 0; i < VERB_COUNT; i++)
        names[i] = verbs[i]->name;
    names[VERB_COUNT] = "help";
    const char *nearest = command_nearest(name, VERB_COUNT + 1, names);
    if (nearest)
        return command_misused("there is no verb \"%s\"; did you mean \"%s\"?", name, nearest);
    return command_misused("there is no verb \"%s\"; the verbs are listed by imukit --help", name);
}

/* The page imukit(1), which lists the verbs. */
static void main_manual(void)
{
    printf(".TH IMUKIT 1 \"\" \"imukit %s\" \"imukit\"\n.SH NAME\nimukit \\- find, simulate and "
           "correct the errors of gyros and accelerometers\n.SH SYNOPSIS\n.B imukit\n.I "
           "VERB\n[operands] [options]\n.SH VERBS\n",
           imk_version());
    for (size_t i = 0; i < VERB_COUNT; i++)
        printf(".TP\n.BR imukit\\-%s (1)\n%s\n", verbs[i]->name, verbs[i]->summary);
    fputs(".SH ENVIRONMENT\n.TP\n.B NO_COLOR\nno colours when set\n.TP\n.B TMPDIR\ndirectory where "
          "a program draws a figure before it is put in place, and where a copy of a pipe is kept "
          "that is read twice\n.TP\n.B IMUKIT_DRAWING_SECONDS\nhow long gnuplot or rsvg-convert "
          "may take for a "
          "figure; default 120\n",
          stdout);
}

/* imukit help [VERB], and the hidden forms packaging uses: help --man [VERB], help --completion. */
static int help(int count, char **words)
{
    bool manual = count > 0 && strcmp(words[0], "--man") == 0;
    if (count > 0 && strcmp(words[0], "--completion") == 0) {
        if (count > 1 && strcmp(words[1], "bash") != 0)
            return command_misused("help --completion %s: only bash is known", words[1]);
        options_completion(verbs, VERB_COUNT, stdout);
        return command_finish(EXIT_DONE);
    }
    const char *name = manual ? (count > 1 ? words[1] : NULL) : count > 0 ? words[0] : NULL;
    if (!name) {
        if (manual)
            main_manual();
        else
            command_welcome(stdout);
        return command_finish(EXIT_DONE);
    }
    const verb *v = find_verb(name);
    if (!v)
        return unknown_verb(name);
    if (manual)
        options_manual(v, stdout);
    else
        options_help(v, stdout);
    return command_finish(EXIT_DONE);
}

/* Errors of other options, too, are to be JSON if it is wanted. */
static void find_json(int count, char **words)
{
    for (int i = 0; i < count && strcmp(words[i], "--") != 0; i++)
        if (strcmp(words[i], "--json") == 0)
            told_wants_json();
}

int command_obey(int argc, char **argv)
{
    if (argc < 2 || strcmp(argv[1], "--help") == 0 || strcmp(argv[1], "-h") == 0) {
        command_welcome(stdout);
        return command_finish(EXIT_DONE);
    }
    if (strcmp(argv[1], "--version") == 0 || strcmp(argv[1], "-V") == 0) {
        printf("imukit %s\n", imk_version());
        return command_finish(EXIT_DONE);
    }
    if (strcmp(argv[1], "help") == 0)
        return help(argc - 2, argv + 2);
    if (argv[1][0] == '-')
        return command_misused("an option must follow a verb: imukit VERB %s", argv[1]);
    const verb *v = find_verb(argv[1]);
    find_json(argc - 2, argv + 2);
    if (!v)
        return command_finish(unknown_verb(argv[1]));
    command_begin(v->name);
    command_line_keep(argc, argv);
    return command_finish(v->run(argc - 2, argv + 2));
}
