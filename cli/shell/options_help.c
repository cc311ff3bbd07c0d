/* SPDX-License-Identifier: Apache-2.0 */
/* The option tables as text: --help, the man page and the bash completion. */
#include "options.h"

#include "command.h"

#include "imukit/log.h"

#include <ctype.h>
#include <string.h>

enum { LINE_WIDTH = 88, HELP_COLUMN = 28, HELP_SIZE = 4096 };

void option_synopsis(const option *o, char *text, size_t size)
{
    char letter[8] = "";
    if (o->letter)
        snprintf(letter, sizeof letter, "-%c, ", o->letter);
    const char *value = o->kind == OPTION_CHOICE ? o->choices : o->value;
    snprintf(text, size, "%s--%s%s%s", letter, o->name, value ? " " : "", value ? value : "");
}

/* A text with the formats of logs where it has "{ or logs}". */
static const char *with_formats(const char *text, char full[HELP_SIZE])
{
    size_t used = 0;
    for (const char *open; (open = strchr(text, '{')); text = strchr(open, '}') + 1) {
        char last[16];
        const size_t length = strcspn(open, "lw}") - 1; /* of what stands before the last */
        snprintf(last, sizeof last, "%.*s", (int)length, open + 1);
        used += (size_t)snprintf(full + used, HELP_SIZE - used, "%.*s", (int)(open - text), text);
        imk_log_formats_text(last, open[length + 1] == 'w', HELP_SIZE - used, full + used);
        used += strlen(full + used);
    }
    snprintf(full + used, HELP_SIZE - used, "%s", text);
    return full;
}

/* Words of a text filled into lines; a blank line in the text separates paragraphs. */
static void fill(FILE *out, const char *text, int indent, int column)
{
    char full[HELP_SIZE];
    text = with_formats(text, full);
    while (*text) {
        if (*text == '\n') {
            fprintf(out, "%s%*s", column > indent ? "\n\n" : "", indent, "");
            column = indent;
            text += strspn(text, "\n");
            continue;
        }
        int length = (int)strcspn(text, " \n");
        if (column > indent && column + 1 + length > LINE_WIDTH) {
            fprintf(out, "\n%*s", indent, "");
            column = indent;
        }
        fprintf(out, "%s%.*s", column > indent ? " " : "", length, text);
        column += length + (column > indent);
        text += length;
        text += strspn(text, " ");
    }
    fputc('\n', out);
}

static void help_option(const option *o, FILE *out)
{
    char synopsis[120];
    option_synopsis(o, synopsis, sizeof synopsis);
    int length = (int)strlen(synopsis);
    if (length > HELP_COLUMN - 4)
        fprintf(out, "  %s\n%*s", synopsis, HELP_COLUMN, "");
    else
        fprintf(out, "  %-*s", HELP_COLUMN - 2, synopsis);
    fill(out, o->help, HELP_COLUMN, HELP_COLUMN);
}

void options_help(const verb *v, FILE *out)
{
    const char *bold = command_color(out, COLOR_BOLD), *reset = command_color(out, COLOR_RESET);
    fprintf(out, "imukit %s: %s\n\n%sExamples%s\n", v->name, v->summary, bold, reset);
    for (int i = 0; i < 2; i++) {
        fprintf(out, "  %s\n      ", v->examples[i].command);
        fill(out, v->examples[i].meaning, 6, 6);
    }
    fprintf(out, "\n%sUsage%s\n  imukit %s%s%s [options]\n\n", bold, reset, v->name,
            *v->operands ? " " : "", v->operands);
    fill(out, v->description, 0, 0);
    for (size_t g = 0; g < GROUPS_MAX && v->groups[g].count; g++) {
        fprintf(out, "\n%s%s%s\n", bold, v->groups[g].title, reset);
        for (size_t i = 0; i < v->groups[g].count; i++)
            help_option(&v->groups[g].options[i], out);
    }
    fprintf(out, "\n%sExit code%s\n  0 done, 1 the data or the computation failed, 2 wrong usage\n",
            bold, reset);
}

/* Text for man(7): a backslash, a leading dot or quote and a hyphen mean something to troff. */
static void troff(FILE *out, const char *text)
{
    bool line_start = true;
    char full[HELP_SIZE];
    text = with_formats(text, full);
    for (const char *c = text; *c; c++) {
        if (line_start && (*c == '.' || *c == '\''))
            fputs("\\&", out);
        if (*c == '\\')
            fputs("\\e", out);
        else if (*c == '-')
            fputs("\\-", out);
        else if (*c == '\n' && c[1] == '\n') {
            fputs("\n.PP\n", out);
            c++;
        } else
            fputc(*c, out);
        line_start = *c == '\n';
    }
}

static void manual_option(const option *o, FILE *out)
{
    char synopsis[120];
    option_synopsis(o, synopsis, sizeof synopsis);
    fputs(".TP\n.B ", out);
    troff(out, synopsis);
    fputc('\n', out);
    troff(out, o->help);
    fputs(".\n", out);
}

void options_manual(const verb *v, FILE *out)
{
    fputs(".TH IMUKIT\\-", out);
    for (const char *c = v->name; *c; c++)
        fputc(toupper((unsigned char)*c), out);
    fprintf(out, " 1 \"\" \"imukit %s\" \"imukit\"\n.SH NAME\nimukit\\-%s \\- ", imk_version(),
            v->name);
    troff(out, v->summary);
    fprintf(out, "\n.SH SYNOPSIS\n.B imukit %s\n.I ", v->name);
    troff(out, v->operands);
    fputs("\n[options]\n.SH EXAMPLES\n", out);
    for (int i = 0; i < 2; i++) {
        fputs(".TP\n.B ", out);
        troff(out, v->examples[i].command);
        fputc('\n', out);
        troff(out, v->examples[i].meaning);
        fputc('\n', out);
    }
    fputs(".SH DESCRIPTION\n", out);
    troff(out, v->description);
    fputs("\n.SH OPTIONS\n", out);
    for (size_t g = 0; g < GROUPS_MAX && v->groups[g].count; g++) {
        fputs(".SS ", out);
        troff(out, v->groups[g].title);
        fputc('\n', out);
        for (size_t i = 0; i < v->groups[g].count; i++)
            manual_option(&v->groups[g].options[i], out);
    }
    fputs(".SH EXIT STATUS\n0 done, 1 the data or the computation failed, 2 wrong usage.\n"
          ".SH SEE ALSO\n.BR imukit (1)\n",
          out);
}

/* "--rate --seed …" of a verb. */
static void completion_words(const verb *v, FILE *out)
{
    for (size_t g = 0; g < GROUPS_MAX; g++)
        for (size_t i = 0; i < v->groups[g].count; i++)
            fprintf(out, "--%s ", v->groups[g].options[i].name);
}

static void completion_choices(const verb *v, FILE *out)
{
    for (size_t g = 0; g < GROUPS_MAX; g++) {
        for (size_t i = 0; i < v->groups[g].count; i++) {
            const option *o = &v->groups[g].options[i];
            if (o->kind != OPTION_CHOICE)
                continue;
            fprintf(out, "        %s:--%s) choices='", v->name, o->name);
            for (const char *c = o->choices; *c; c++)
                fputc(*c == '|' ? ' ' : *c, out);
            fputs("' ;;\n", out);
        }
    }
}

void options_completion(const verb *const *verbs, size_t count, FILE *out)
{
    fputs("# bash completion for imukit; made by: imukit help --completion bash\n"
          "_imukit()\n{\n"
          "    local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]}\n"
          "    local verb=${COMP_WORDS[1]} choices=''\n"
          "    if [ \"$COMP_CWORD\" -eq 1 ]; then\n        COMPREPLY=($(compgen -W '",
          out);
    for (size_t i = 0; i < count; i++)
        fprintf(out, "%s ", verbs[i]->name);
    fputs("help --help --version' -- \"$word\"))\n        return\n    fi\n"
          "    case $verb:$before in\n",
          out);
    for (size_t i = 0; i < count; i++)
        completion_choices(verbs[i], out);
    fputs("    esac\n    if [ -z \"$choices\" ] && [[ $word == -* ]]; then\n"
          "        case $verb in\n",
          out);
    for (size_t i = 0; i < count; i++) {
        fprintf(out, "        %s) choices='", verbs[i]->name);
        completion_words(verbs[i], out);
        fputs("--help' ;;\n", out);
    }
    fputs("        esac\n    fi\n"
          "    if [ -n \"$choices\" ]; then\n"
          "        COMPREPLY=($(compgen -W \"$choices\" -- \"$word\"))\n"
          "    else\n        COMPREPLY=($(compgen -f -- \"$word\"))\n    fi\n}\n"
          "complete -o filenames -F _imukit imukit\n",
          out);
}
