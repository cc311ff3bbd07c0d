/* SPDX-License-Identifier: Apache-2.0 */
/* imukit spectrum: power spectral density of a log, its lines, and the noise it shows. */
#include "spectrum_output.h"

#include <math.h>
#include <stdlib.h>

static const option spectrum_option_table[] = {
    {"method", 0, OPTION_CHOICE, "CHOICE", NULL, "welch|multitaper",
     "averaged windowed segments (the default), or Slepian tapers, for records too short to be "
     "cut up",
     offsetof(spectrum_options, method)},
    {"resolution", 0, OPTION_QUANTITY, "BANDWIDTH", "Hz", "positive",
     "how far two lines must be apart to be told from each other; default: 31 segments, or one for "
     "multitaper",
     offsetof(spectrum_options, resolution)},
    {"window", 0, OPTION_CHOICE, "CHOICE", NULL, "hann|blackman-harris|kaiser",
     "of the segments; the latter two for weak lines beside strong ones",
     offsetof(spectrum_options, window)},
    {"trend", 0, OPTION_FLAG, NULL, NULL, NULL,
     "remove a straight line from each segment, not its mean only",
     offsetof(spectrum_options, trend)},
    {"density", 0, OPTION_CHOICE, "SIDES", NULL, "two-sided|one-sided",
     "of the densities shown: IEEE's convention (the default), or twice that as many data sheets "
     "and analysers have it; parameters are always two-sided",
     offsetof(spectrum_options, density)},
    {"false-alarm", 0, OPTION_FRACTION, "FRACTION", NULL, NULL,
     "chance that a channel without lines shows any; default 0.001",
     offsetof(spectrum_options, false_alarm)},
    {"from", 0, OPTION_QUANTITY, "FREQUENCY", "Hz", "not negative",
     "lowest frequency the noise parameters are fitted to; default: the lowest resolved",
     offsetof(spectrum_options, from)},
    {"to", 0, OPTION_QUANTITY, "FREQUENCY", "Hz", "positive",
     "highest; set it below the sensor's own filter; default: half the sample rate",
     offsetof(spectrum_options, to)},
    {"confidence", 0, OPTION_FRACTION, "FRACTION", NULL, CONFIDENCE_RANGE,
     "of the two-sided intervals; default 0.95", offsetof(spectrum_options, confidence)},
    {"output", 'o', OPTION_OUTPUT, "FILE.csv", NULL, NULL,
     "write the densities (100 per decade, one line per channel and frequency, SI) here; - is "
     "standard output",
     offsetof(spectrum_options, output)},
    {"plot", 0, OPTION_OUTPUT, "FILE.svg|.png|.pdf|term", NULL, NULL,
     "draw the root densities with their intervals, lines marked",
     offsetof(spectrum_options, plot)},
    {"report", 0, OPTION_OUTPUT, "FILE.html", NULL, NULL,
     "write one self-contained page: plot and tables", offsetof(spectrum_options, report)},
    {"json", 0, OPTION_FLAG, NULL, NULL, NULL, "print the result as JSON instead of tables",
     offsetof(spectrum_options, json)},
    {"threads", 0, OPTION_INTEGER, "N", NULL, "1-65536", "threads to use; default: all processors",
     offsetof(spectrum_options, threads)},
};

static int run(int count, char **words);

const verb spectrum_verb = {
    .name = "spectrum",
    .summary = "power spectral density of a log, its lines and its noise",
    .operands = "LOG",
    .operands_minimum = 1,
    .operands_maximum = 1,
    .examples = {{"imukit spectrum static.csv --plot spectrum.svg",
                  "densities, vibration and interference lines, noise parameters of every channel"},
                 {"imukit spectrum bench.csv --resolution 0.01Hz --density one-sided -o psd.csv",
                  "finer, and in the convention of most spectrum analysers, as a table"}},
    .description =
        "LOG is CSV with a header such as time [s],gyro_x [deg/s],accel_x [g] (also .gz, .zst), or "
        ".npy; - is standard input. Without gyro and accelerometer columns every other column is "
        "analysed.\n\nLines are listed with frequency, amplitude and what they are multiples of. "
        "The noise parameters are a cross-check of imukit identify, which is the better "
        "estimator; where they differ, something that neither models is in the log.",
    .groups = {{"Options", sizeof spectrum_option_table / sizeof spectrum_option_table[0],
                spectrum_option_table, 0},
               {"Reading the log", LOG_INPUT_OPTIONS, log_input_options,
                offsetof(spectrum_options, log)}},
    .run = run};

static imk_spectrum_settings settings_of(const spectrum_result *r)
{
    const spectrum_options *o = r->options;
    imk_spectrum_settings settings = imk_spectrum_default();
    settings.method = (imk_spectrum_method)o->method;
    settings.window = (imk_window)o->window;
    settings.overlap = o->window == 0 ? 0.5 : 0.66; /* narrower windows use less of a segment */
    settings.dt = r->channels.dt;
    settings.resolution = o->resolution;
    settings.trend = o->trend;
    return settings;
}

/* An estimate with its arrays in `*memory`, from malloc(). */
static imk_status estimate(const imk_spectrum_settings *settings, size_t n, const double *samples,
                           imk_spectrum *spectrum, double **memory, imk_error *error)
{
    const size_t count = imk_spectrum_count(settings, n);
    const size_t size = imk_spectrum_workspace_size(settings, n);
    *memory = malloc((3 * count + 1) * sizeof **memory);
    void *workspace = malloc(size + 1);
    imk_status status = IMK_ERROR_MEMORY;
    if (*memory && workspace)
        status = imk_spectrum_estimate(settings, n, samples, spectrum, *memory, *memory + count,
                                       *memory + 2 * count, workspace, size, error);
    else
        imk_error_set(error, status, "", "", "");
    free(workspace);
    return status;
}

static imk_status find_lines(const spectrum_result *r, channel_spectrum *f, const double *samples)
{
    const size_t size = imk_spectrum_lines_workspace_size(&f->spectrum, r->channels.rows);
    void *workspace = malloc(size);
    imk_status status = IMK_ERROR_MEMORY;
    if (workspace)
        status =
            imk_spectrum_lines(&f->spectrum, r->channels.rows, samples, r->options->false_alarm,
                               SPECTRUM_LINES_MAX, f->line, &f->line_count, workspace, size);
    free(workspace);
    return status;
}

static imk_status make_bands(const spectrum_result *r, channel_spectrum *f)
{
    enum { DECADES = 12 };
    const size_t plotted = SPECTRUM_PLOTTED_PER_DECADE * DECADES;
    const size_t table = SPECTRUM_TABLE_PER_DECADE * DECADES;
    f->plotted = malloc((plotted + table) * sizeof *f->plotted);
    if (!f->plotted)
        return IMK_ERROR_MEMORY;
    f->table = f->plotted + plotted;
    f->plotted_count = imk_spectrum_bands(&f->spectrum, SPECTRUM_PLOTTED_PER_DECADE,
                                          r->options->confidence, 0, NULL, plotted, f->plotted);
    f->table_count =
        imk_spectrum_bands(&f->spectrum, SPECTRUM_TABLE_PER_DECADE, r->options->confidence,
                           f->line_count, f->line, table, f->table);
    return IMK_OK;
}

/* The parameters need the slow end more than the lines need averages: seven Hann segments, of at
 * most 2^22 samples. Lines keep their frequencies and get the bins of that spectrum. */
static void fit_parameters(const spectrum_result *r, channel_spectrum *f, const double *samples)
{
    enum { SEGMENT_MAX = 1 << 22, PARTS = 4 };
    const size_t n = r->channels.rows;
    const double length = fmin((double)n / PARTS, SEGMENT_MAX);
    imk_spectrum_settings settings = imk_spectrum_default();
    imk_spectrum fine;
    imk_spectrum_line line[SPECTRUM_LINES_MAX];
    double *memory = NULL;
    settings.dt = r->channels.dt;
    settings.trend = r->options->trend;
    settings.resolution = 1.5 / (length * settings.dt);
    f->fit_status = estimate(&settings, n, samples, &fine, &memory, NULL);
    for (size_t i = 0; f->fit_status == IMK_OK && i < f->line_count; i++) {
        const double ratio = f->spectrum.step / fine.step;
        line[i] = f->line[i];
        line[i].first = (size_t)fmax(1, floor((double)line[i].first * ratio));
        line[i].last = (size_t)ceil((double)line[i].last * ratio);
    }
    if (f->fit_status == IMK_OK)
        f->fit_status = imk_spectrum_fit(&fine, f->line_count, line, r->options->from,
                                         r->options->to, r->options->confidence, 0.01, &f->fit);
    free(memory);
}

static void analyse(void *context, size_t channel)
{
    spectrum_result *r = context;
    channel_spectrum *f = &r->found[channel];
    const double *samples = log_channel_data(&r->channels, channel);
    const imk_spectrum_settings settings = settings_of(r);
    f->status = estimate(&settings, r->channels.rows, samples, &f->spectrum, &f->memory, &f->error);
    if (f->status == IMK_OK)
        f->status = find_lines(r, f, samples);
    if (f->status == IMK_OK)
        f->status = make_bands(r, f);
    if (f->status == IMK_OK)
        fit_parameters(r, f, samples);
    if (f->fit_status == IMK_ERROR_MEMORY) /* says nothing about the log */
        f->status = f->fit_status;
}

/* What a channel could not be analysed for, as a sentence. */
static int explain(const spectrum_result *r, size_t channel)
{
    const channel_spectrum *f = &r->found[channel];
    const char *name = log_channel_column(&r->channels, channel)->name;
    const double span = (double)r->channels.rows * r->channels.dt;
    if (f->status == IMK_ERROR_CONSTANT)
        return command_failed("%s: column %s is constant in all %zu rows: there is no noise to "
                              "analyse; leave it out with --columns, or check the log",
                              r->path, name, r->channels.rows);
    if (f->status == IMK_ERROR_TOO_SHORT)
        return command_failed("%s: %zu rows are too few for a spectrum; 64 are needed, and some "
                              "thousands useful",
                              r->path, r->channels.rows);
    if (f->status == IMK_ERROR_RANGE && r->options->resolution > 0)
        return command_misused("--resolution %g Hz: %s; this record of %g s at %g Hz allows "
                               "about %.2g Hz to %.2g Hz",
                               r->options->resolution, f->error.found, span, 1 / r->channels.dt,
                               (r->options->method ? 8 : 1.5) / span,
                               (r->options->method ? 0.5 : 0.09) / r->channels.dt);
    if (f->status == IMK_ERROR_GAP)
        return command_failed("%s: column %s: every segment has missing samples; ask for a coarser "
                              "--resolution, or use --gaps longest",
                              r->path, name);
    return command_failed("%s: column %s: %s", r->path, name, imk_status_text(f->status));
}

static void warn_about(const spectrum_result *r, size_t channel)
{
    const channel_spectrum *f = &r->found[channel];
    const char *name = log_channel_column(&r->channels, channel)->name;
    if (f->spectrum.left_out > 0)
        command_warn("gaps", "%s: %zu of %zu segments have missing samples and were left out", name,
                     f->spectrum.left_out, f->spectrum.left_out + f->spectrum.segments);
    if (f->line_count == SPECTRUM_LINES_MAX)
        command_warn("lines", "%s: more than %d lines; the strongest are listed", name,
                     SPECTRUM_LINES_MAX);
    if (f->fit_status != IMK_OK)
        command_warn("fit", "%s: the noise parameters could not be fitted: %s", name,
                     imk_status_text(f->fit_status));
    else if (f->fit.misfit > 2)
        command_warn("misfit",
                     "%s: the four noise terms do not explain the spectrum (misfit %.1f, worst at "
                     "%.3g Hz: %.2f of the fit); an output filter, a resonance or a correlated "
                     "noise is there: see imukit identify, or fit a part with --from and --to",
                     name, f->fit.misfit, f->fit.worst_frequency, f->fit.worst_ratio);
}

static int compute(spectrum_result *r, const imk_executor *executor)
{
    const spectrum_options *o = r->options;
    if (o->to > 0 && !(o->from < o->to))
        return command_misused("--from %g Hz is not below --to %g Hz", o->from, o->to);
    const double half_rate = 0.5 / r->channels.dt;
    if (!(o->from < half_rate))
        return command_misused("--from %g Hz: the spectrum of %s ends at half its sample rate, "
                               "%.6g Hz",
                               o->from, r->path, half_rate);
    imk_execute(executor, r->channels.count, analyse, r);
    for (size_t c = 0; c < r->channels.count; c++)
        if (r->found[c].status != IMK_OK)
            return explain(r, c);
    for (size_t c = 0; c < r->channels.count; c++)
        warn_about(r, c);
    return -1;
}

static int show(const spectrum_result *r)
{
    const spectrum_options *o = r->options;
    int code = -1;
    if (o->output)
        code = spectrum_write_csv(r, o->output);
    if (code < 0 && o->report)
        code = spectrum_write_report(r, o->report);
    if (code < 0 && o->json)
        code = spectrum_print_json(r);
    if (code < 0 && !o->json && !o->output && !options_stdout_taken())
        spectrum_print_tables(r);
    if (code < 0 && o->plot)
        code = spectrum_draw(r, o->plot);
    return code < 0 ? EXIT_DONE : code;
}

static int run(int count, char **words)
{
    spectrum_options o = {.confidence = 0.95, .false_alarm = 1e-3};
    const char *operands[OPERANDS_MAX];
    int code = options_parse(&spectrum_verb, count, words, &o, operands);
    if (code < 0)
        code = command_check_plot(o.plot);
    if (code >= 0)
        return code;
    spectrum_result *r = calloc(1, sizeof *r);
    if (!r)
        return command_failed("memory is exhausted");
    r->options = &o;
    r->path = operands[0];
    code = log_input_load(&o.log, r->path, &r->channels);
    if (code < 0) {
        imk_thread_pool *pool = imk_thread_pool_create(o.threads.value);
        imk_executor executor = imk_thread_pool_executor(pool);
        code = compute(r, &executor);
        imk_thread_pool_destroy(pool);
        if (code < 0)
            code = show(r);
        for (size_t c = 0; c < r->channels.count; c++) {
            free(r->found[c].memory);
            free(r->found[c].plotted);
        }
        log_channels_free(&r->channels);
    }
    free(r);
    return code;
}
