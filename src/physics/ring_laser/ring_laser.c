/* SPDX-License-Identifier: Apache-2.0 */
/* The ring laser gyro as an instrument: its design, its start, its readout. The equations are in
 * ring_laser_dynamics.c. */
#include "ring_laser_internal.h"

#include "physics/design_rows_internal.h"

#include <math.h>
#include <string.h>

enum { COOKIE = 0x524C4731 };

#define DEGREE_PER_HOUR (IMKI_PI / 180.0 / 3600.0)

imk_ring_laser imk_ring_laser_default(void)
{
    const double floor_per_b = 0.6643; /* sqrt(2 ln 2/pi), of flicker noise [IEEE952] */
    return (imk_ring_laser){
        .cookie = COOKIE,
        .cavity = {.perimeter = 0.16, .wavelength = 632.8e-9, .loss = 300e-6, .power = 10e-3},
        .lock_in = {.rate = 152.5 * DEGREE_PER_HOUR},
        .dither = {.frequency = 517.0, .rate = 150.0 * IMKI_DEGREE, .randomness = 0.02},
        .null_shift = {.repeatability = 0.003 * DEGREE_PER_HOUR,
                       .instability = 0.0035 / floor_per_b * DEGREE_PER_HOUR},
        .scale_factor = {.repeatability = 5.0 * 1e-6},
        .path_length = {.expansion = 2e-8, .stroke = 2e-6},
        .readout = {.decoding = IMK_RING_LASER_QUARTERS, .range = 900.0 * IMKI_DEGREE},
        .temperature = {.reference = 293.15, .minimum = -54.0 + 273.15, .maximum = 344.15}};
}

/* ---- tables ---------------------------------------------------------------------------------- */

/* The limits keep what is computed finite; rates up to 1e4 deg/s, cavities from chips to rooms. */
#define DESIGN imk_ring_laser
static const imk_design_field fields[] = {
    CHOICE("cavity.shape", cavity.shape, "triangle|square", "path of the beams"),
    NUMBER("cavity.perimeter", cavity.perimeter, "m", 1e-3, 1e3, "length of the path"),
    NUMBER("cavity.wavelength", cavity.wavelength, "nm", 1e-7, 1e-5, "of the light"),
    ABOVE("cavity.loss", cavity.loss, "ppm", 0.0, 0.5,
          "part of a beam's energy lost in a round trip"),
    ABOVE("cavity.power", cavity.power, "mW", 0.0, 1e6, "circulating in each beam"),
    NUMBER("lock_in.rate", lock_in.rate, "deg/h", 0.0, 175.0, "without dither, rates below read 0"),
    NUMBER("lock_in.phase", lock_in.phase, "deg", -10.0, 10.0, "phase of the backscattered light"),
    NUMBER("dither.frequency", dither.frequency, "Hz", 1.0, 1e5, "of the oscillation"),
    NUMBER("dither.rate", dither.rate, "deg/s", 0.0, 175.0, "peak rate; 0: no dither"),
    NUMBER("dither.randomness", dither.randomness, "%", 0.0, 0.1,
           "1 sigma of the amplitude from half cycle to half cycle"),
    NUMBER("null_shift.fixed", null_shift.fixed, "deg/h", -1.0, 1.0, "bias of the beat"),
    NUMBER("null_shift.repeatability", null_shift.repeatability, "deg/h", 0.0, 1.0,
           "1 sigma from run to run"),
    NUMBER("null_shift.instability", null_shift.instability, "deg/h", 0.0, 1.0,
           "flicker B within a run"),
    NUMBER("null_shift.temperature", null_shift.temperature, "deg/h/K", -0.01, 0.01,
           "change per kelvin"),
    NUMBER("scale_factor.error", scale_factor.error, "ppm", -0.1, 0.1,
           "of the geometry against its nominal value"),
    NUMBER("scale_factor.repeatability", scale_factor.repeatability, "ppm", 0.0, 0.1,
           "1 sigma from run to run"),
    NUMBER("path_length.expansion", path_length.expansion, "ppm/K", -1e-4, 1e-4,
           "relative change of the perimeter with temperature"),
    NUMBER("path_length.stroke", path_length.stroke, "um", 0.0, 1e-2,
           "change of the perimeter that its control can make, end to end"),
    NUMBER("alignment.y", alignment.y, "mrad", -0.1, 0.1, "response to rates about y"),
    NUMBER("alignment.z", alignment.z, "mrad", -0.1, 0.1, "response to rates about z"),
    CHOICE("readout.decoding", readout.decoding, "fringes|halves|quarters", "what makes one count"),
    CHOICE("readout.stripping", readout.stripping, "pickoff|periods",
           "how the dither is taken out of the reading"),
    NUMBER("readout.pickoff_error", readout.pickoff_error, "%", -1.0, 1.0,
           "gain of the dither pickoff less 1"),
    ABOVE("readout.range", readout.range, "deg/s", 0.0, 1e4, "larger rates are put out as this"),
    NUMBER("temperature.reference", temperature.reference, "degC", 1.0, 1000.0,
           "where null shift and path length are set"),
    NUMBER("temperature.minimum", temperature.minimum, "degC", 1.0, 1000.0, "of operation"),
    NUMBER("temperature.maximum", temperature.maximum, "degC", 1.0, 1000.0, "of operation"),
};

static const imk_signal outputs[] = {
    {"rate", "rad/s", "deg/h", "measured rate, dither taken out"},
    {"counts", "1", "1", "of the sample, dither included"},
};

enum { PHASE, SLOW_PHASE, DITHER_ANGLE, DITHER_RATE, BEAT, PULL, NULL_SHIFT, MODE, SIGNALS };
static const imk_signal signals[SIGNALS] = {
    [PHASE] = {"phase", "rad", "rad", "of the beat"},
    [SLOW_PHASE] = {"phase_without_dither", "rad", "rad", "of the beat, less that of the dither"},
    [DITHER_ANGLE] = {"dither_angle", "rad", "arcsec", "of the body against its case"},
    [DITHER_RATE] = {"dither_rate", "rad/s", "deg/s", "of the body against its case"},
    [BEAT] = {"beat_frequency", "Hz", "kHz", "of the fringes, with their direction"},
    [PULL] = {"lock_in_pull", "rad/s", "deg/h", "rate error by backscatter at this phase"},
    [NULL_SHIFT] = {"null_shift", "rad/s", "deg/h", "of this sample"},
    [MODE] = {"mode", "1", "1", "wavelengths the path has more than at the reference"},
};

static const imk_view views[] = {
    {.title = "Dither and beat",
     .caption = "The beat follows the dither, up to a hundred thousand fringes a second, and turns "
                "round with it twice a cycle. The amplitude changes in the middle of each swing.",
     .x = -1,
     .curve_count = 1,
     .y = {BEAT},
     .duration = 4e-3,
     .rate = 500e3},
    {.title = "Kicks at the turns of the dither",
     .caption = "The phase of the beat less that of the dither and the ramp of the input. Quantum "
                "noise makes it wander; lock-in kicks it, twice a cycle, where the beat turns "
                "round.",
     .x = -1,
     .curve_count = 1,
     .y = {SLOW_PHASE},
     .duration = 20e-3,
     .rate = 200e3,
     .less_ramp = true},
    {.title = "The pull of lock-in",
     .caption = "Backscatter pulls the rate up and down with every fringe; only where the beat is "
                "slow does it pull one way for long.",
     .x = -1,
     .curve_count = 1,
     .y = {PULL},
     .duration = 0.25e-3,
     .rate = 4e6,
     .settle = 0.36e-3},
    {.title = "Phase of the beat without the dither",
     .caption = "With random dither, the phase wanders along the straight line of the input. "
                "Without dither, just outside the lock-in band, it forms a staircase: the beat "
                "lingers, then slips a fringe.",
     .x = -1,
     .curve_count = 1,
     .y = {SLOW_PHASE},
     .duration = 0.5,
     .rate = 2e3},
};

/* ---- checks ---------------------------------------------------------------------------------- */

/* Beyond this a phase has no digits left [fringes/rad]; noise as large as the range of any gyro
 * [rad/s /sqrt(Hz)]. */
static const double most_fringes = 1e12, most_noise = 1.0;

static imk_status check(const void *given, imk_error *error)
{
    const imk_ring_laser *design = given;
    const double fringes = imk_ring_laser_fringes_per_radian(design);
    const double noise = imk_ring_laser_quantum_noise(design);
    if (!(fringes <= most_fringes))
        return imki_conflict(error, "cavity.perimeter", design->cavity.perimeter,
                             design->cavity.perimeter * (most_fringes / fringes),
                             "a ring of at most 1e12 fringes per radian");
    if (!(noise <= most_noise))
        return imki_conflict(error, "cavity.power", design->cavity.power,
                             design->cavity.power * noise * noise,
                             "more power, less loss or a larger ring: its quantum noise must be at "
                             "most 1 rad/s/sqrt(Hz)");
    if (design->dither.rate > 0.0 && !(design->dither.rate > design->lock_in.rate))
        return imki_conflict(error, "dither.rate", design->dither.rate, design->lock_in.rate,
                             "a peak rate above lock_in.rate, or 0 for no dither");
    if (!(design->path_length.stroke >= design->cavity.wavelength))
        return imki_conflict(
            error, "path_length.stroke", design->path_length.stroke, design->cavity.wavelength,
            "at least the wavelength, so that the control can reach the next mode");
    if (!(design->temperature.minimum < design->temperature.reference))
        return imki_conflict(error, "temperature.minimum", design->temperature.minimum,
                             design->temperature.reference,
                             "a temperature below temperature.reference");
    if (!(design->temperature.reference < design->temperature.maximum))
        return imki_conflict(error, "temperature.maximum", design->temperature.maximum,
                             design->temperature.reference,
                             "a temperature above temperature.reference");
    return IMK_OK;
}

/* K th_d [rad], with the largest scale factor a run can have. */
static double dither_phase(const imk_ring_laser *design)
{
    return 2.0 * IMKI_PI * imk_ring_laser_fringes_per_radian(design) *
           imk_ring_laser_dither_angle(design);
}

double imki_ring_laser_step(const imk_ring_laser *design, double bend, double pull, double cycle)
{
    const double kappa =
        2.0 * IMKI_PI * imk_ring_laser_fringes_per_radian(design) * design->lock_in.rate;
    double step = pull / kappa; /* infinite without lock-in */
    if (design->dither.rate > 0.0) {
        const double omega = 2.0 * IMKI_PI * design->dither.frequency;
        step = fmin(step, cycle / design->dither.frequency);
        step = fmin(step, sqrt(bend / dither_phase(design)) / omega);
    }
    return fmin(step, 1e9); /* any: the rest is exact */
}

static double step_length(const void *design, const imk_physics_settings *settings)
{
    const imk_ring_laser *d = design;
    if (settings->level == IMK_LEVEL_SLOW)
        return 0.5 / d->dither.frequency;
    return fmin(
        1.0 / settings->rate,
        imki_ring_laser_step(d, IMKI_RING_LASER_BEND, IMKI_RING_LASER_PULL, IMKI_RING_LASER_CYCLE));
}

/* The kick map needs turns that are short against a cycle, and kicks that are small. */
static imk_status check_slow(const imk_ring_laser *design, const imk_physics_settings *settings,
                             imk_error *error)
{
    const double least = 20.0, largest = 0.5; /* [rad] */
    const double phase = dither_phase(design), half_cycle = 0.5 / design->dither.frequency;
    if (!(design->dither.rate > 0.0))
        return imki_refuse(error, IMK_ERROR_UNSUPPORTED, "level", (double)settings->level, 0.0,
                           "choose the full level: without dither there are no kicks");
    if (!(phase >= least))
        return imki_refuse(error, IMK_ERROR_UNSUPPORTED, "level", phase, least,
                           "choose the full level, or a dither of 20 rad of phase or more");
    const double kick = design->lock_in.rate / design->dither.rate * sqrt(2.0 * IMKI_PI * phase);
    if (!(kick <= largest))
        return imki_refuse(error, IMK_ERROR_UNSUPPORTED, "level", kick, largest,
                           "choose the full level, or more dither for kicks of 0.5 rad or less");
    if (settings->step > half_cycle)
        return imki_refuse(
            error, IMK_ERROR_RANGE, "step", settings->step, half_cycle,
            "at most half a cycle of the dither, which is one step of the slow level");
    return IMK_OK;
}

/* ---- start ----------------------------------------------------------------------------------- */

/* Random numbers and what they begin with. */
static void start_random(imki_ring_laser *gyro, const imk_physics_settings *settings)
{
    const imk_ring_laser *design = &gyro->design;
    imki_draws_start(&gyro->quantum_draws, settings, IMKI_RING_LASER_QUANTUM);
    imki_draws_start(&gyro->dither_draws, settings, IMKI_RING_LASER_DITHER);
    imki_wander_start(&gyro->null_wander, settings, IMKI_RING_LASER_NULL,
                      design->null_shift.repeatability, design->null_shift.instability);
    gyro->fringes =
        imk_ring_laser_fringes_per_radian(design) *
        (1.0 + design->scale_factor.error +
         imki_run_constant(settings, IMKI_RING_LASER_SCALE, design->scale_factor.repeatability));
    /* a normal of ten fringes is a uniform phase to one in 1e85 */
    imki_fringes_add(&gyro->beat, imki_run_constant(settings, IMKI_RING_LASER_START, 10.0));
    gyro->beat.whole = 0;
}

/* 2^64 times the fractional part of x >= 0. */
static uint64_t fraction_bits(double x)
{
    const double part = x - floor(x);
    return (uint64_t)(part * 0x1p32) << 32 |
           (uint64_t)((part * 0x1p32 - floor(part * 0x1p32)) * 0x1p32);
}

static void start_dither(imki_ring_laser *gyro)
{
    const imk_ring_laser *design = &gyro->design;
    const double cycles = design->dither.frequency * gyro->dt;
    const double per_step = design->dither.frequency * gyro->step;
    double sine, cosine;
    gyro->dithers = design->dither.rate > 0.0;
    gyro->angle = imk_ring_laser_dither_angle(design);
    imki_ring_laser_next_amplitude(gyro);
    gyro->whole_cycles = floor(cycles);
    gyro->phase_sample = fraction_bits(cycles);
    gyro->phase_step = fraction_bits(per_step);
    imki_ring_laser_sine(per_step, &gyro->turn_s, &gyro->turn_c);
    imki_ring_laser_sine(0.25 * per_step, &sine, &cosine);
    /* of sin(2 pi phase) in the middle of a step against the mean of its ends: 1 - cos = 2 sin^2 of
     * half the angle; the parabola has an eighth of its second difference there */
    const double half_cosine = 1.0 - 2.0 * sine * sine;
    gyro->bend = -8.0 * 2.0 * IMKI_PI * 2.0 * sine * sine / (2.0 * half_cosine);
}

/* The small terms in the phase of a kick: ring_laser_dynamics.c. */
static void start_kicks(imki_ring_laser *gyro)
{
    const double euler = 0.57721566490153286; /* Euler's constant */
    const double omega = 2.0 * IMKI_PI * gyro->design.dither.frequency;
    const double phase = 2.0 * IMKI_PI * gyro->fringes * gyro->angle; /* K A [rad] */
    const double ratio = gyro->kappa / omega;
    gyro->radian_time = 1.0 / omega;
    gyro->merged = 1.0 / sqrt(phase);
    gyro->kick_phase = 0.125 / phase / (2.0 * IMKI_PI);
    gyro->kick_pull =
        0.25 * ratio * ratio / phase * (imk_ln(4.0 * phase) + euler) / (2.0 * IMKI_PI);
}

static imk_status init(const void *given, const imk_physics_settings *settings, void *state,
                       imk_error *error)
{
    const imk_ring_laser *design = given;
    imki_ring_laser *gyro = state;
    imk_status status;
    gyro->design = *design;
    gyro->level = settings->level;
    gyro->dt = 1.0 / settings->rate;
    if (settings->level == IMK_LEVEL_SLOW) {
        status = check_slow(design, settings, error);
        gyro->steps = 1;
        gyro->step = gyro->dt;
    } else {
        const double limit =
            imki_ring_laser_step(design, IMKI_RING_LASER_BEND_LIMIT, IMKI_RING_LASER_PULL_LIMIT,
                                 IMKI_RING_LASER_CYCLE_LIMIT);
        status = imki_divide_sample(
            settings, step_length(design, settings), limit,
            "use shorter steps, which follow the turns of the dither and lock-in", &gyro->steps,
            &gyro->step, error);
    }
    if (status != IMK_OK)
        return status;
    start_random(gyro, settings);
    gyro->kappa = 2.0 * IMKI_PI * gyro->fringes * design->lock_in.rate;
    gyro->scatter = design->lock_in.phase / (2.0 * IMKI_PI);
    gyro->noise = settings->noise ? gyro->fringes * imk_ring_laser_quantum_noise(design) : 0.0;
    if (settings->level == IMK_LEVEL_FULL)
        gyro->noise *= sqrt(gyro->step);
    gyro->multiple = (double)(1 << (int)design->readout.decoding);
    gyro->count_angle = imk_ring_laser_count_angle(design);
    gyro->slope = gyro->fringes;
    start_dither(gyro);
    if (gyro->level == IMK_LEVEL_SLOW)
        start_kicks(gyro);
    gyro->counts = imki_ring_laser_count(gyro, gyro->beat);
    gyro->latched[0] = gyro->latched[1] = gyro->stripped = gyro->counts;
    return IMK_OK;
}

/* ---- a sample -------------------------------------------------------------------------------- */

/* The path length control holds the perimeter at a whole number of wavelengths. What it has to
 * make up for grows with temperature; at the end of its stroke it goes to the mode nearest to its
 * middle, which is where it starts, too. */
static void control_path(imki_ring_laser *gyro, double temperature)
{
    const imk_ring_laser *design = &gyro->design;
    const double grown = design->path_length.expansion * design->cavity.perimeter *
                         (temperature - design->temperature.reference);
    const double moved = grown - gyro->mode * design->cavity.wavelength;
    if (!gyro->warm || fabs(moved) > 0.5 * design->path_length.stroke) {
        gyro->mode = nearbyint(grown / design->cavity.wavelength);
        gyro->slope = gyro->fringes * (1.0 + gyro->mode * imk_ring_laser_mode_hop(design));
        gyro->warm = true;
    }
}

static double null_shift(imki_ring_laser *gyro, double temperature)
{
    const imk_ring_laser *design = &gyro->design;
    const double within =
        fmin(fmax(temperature, design->temperature.minimum), design->temperature.maximum);
    return design->null_shift.fixed + imki_wander_next(&gyro->null_wander) +
           design->null_shift.temperature * (within - design->temperature.reference);
}

/* Fringes with the dither in them. */
static imki_fringes whole_beat(const imki_ring_laser *gyro)
{
    imki_fringes fringes = gyro->beat;
    if (gyro->level == IMK_LEVEL_SLOW)
        imki_fringes_add(&fringes, gyro->slope * gyro->amplitude * gyro->sine);
    return fringes;
}

/* Angle of the last whole cycles of the dither [rad]: between the beginnings of two cycles the
 * reading goes in a straight line, a cycle late, so that their sum is never lost. */
static double whole_periods(imki_ring_laser *gyro)
{
    const double part = (double)gyro->phase * 0x1p-64;
    const double ahead = part * (double)(gyro->latched[1] - gyro->latched[0]);
    const double counts =
        (double)(gyro->latched[0] - gyro->stripped) + (ahead - gyro->stripped_part);
    gyro->stripped = gyro->latched[0];
    gyro->stripped_part = ahead;
    return counts * gyro->count_angle;
}

static void step(void *state, const imk_exposure *exposure, double *readings)
{
    imki_ring_laser *gyro = state;
    const imk_ring_laser *design = &gyro->design;
    control_path(gyro, exposure->temperature);
    gyro->null_shift = null_shift(gyro, exposure->temperature);
    const double turning = exposure->angular_rate[0] +
                           design->alignment.y * exposure->angular_rate[1] +
                           design->alignment.z * exposure->angular_rate[2];
    /* so that the fringes can be counted */
    const double rate =
        gyro->null_shift + fmin(fmax(turning, -IMKI_EXPOSURE_RATE_MAX), IMKI_EXPOSURE_RATE_MAX);
    gyro->rate = rate;
    if (gyro->level == IMK_LEVEL_SLOW)
        imki_ring_laser_slow(gyro, rate);
    else
        imki_ring_laser_full(gyro, rate);

    const int64_t counts = imki_ring_laser_count(gyro, whole_beat(gyro));
    const double pickoff = (1.0 + design->readout.pickoff_error) * gyro->amplitude * gyro->sine;
    const double counted = (double)(counts - gyro->counts);
    double angle = counted * gyro->count_angle;
    if (gyro->dithers && design->readout.stripping == IMK_RING_LASER_PERIODS)
        angle = whole_periods(gyro);
    else if (gyro->dithers)
        angle -= pickoff - gyro->pickoff;
    gyro->counts = counts;
    gyro->pickoff = pickoff;
    readings[0] = fmin(fmax(angle / gyro->dt, -design->readout.range), design->readout.range);
    readings[1] = counted;
}

static void observe(const void *state, double *values)
{
    const imki_ring_laser *gyro = state;
    const double phase = (double)gyro->phase * 0x1p-64;
    const imki_fringes beat = whole_beat(gyro);
    double sine, cosine, pull_sine, pull_cosine;
    imki_ring_laser_sine(phase, &sine, &cosine);
    imki_ring_laser_sine(beat.part + gyro->scatter, &pull_sine, &pull_cosine);
    const double angle = gyro->dithers ? gyro->amplitude * sine : 0.0;
    const double pull = gyro->design.lock_in.rate * pull_sine;
    const double dither_rate =
        gyro->dithers ? 2.0 * IMKI_PI * gyro->design.dither.frequency * gyro->amplitude * cosine
                      : 0.0;
    values[PHASE] = 2.0 * IMKI_PI * ((double)beat.whole + beat.part);
    values[SLOW_PHASE] = 2.0 * IMKI_PI * ((double)beat.whole + (beat.part - gyro->slope * angle));
    values[DITHER_ANGLE] = angle;
    values[DITHER_RATE] = dither_rate;
    values[BEAT] = gyro->slope * (gyro->rate + dither_rate - pull);
    values[PULL] = -pull;
    values[NULL_SHIFT] = gyro->null_shift;
    values[MODE] = gyro->mode;
}

IMKI_DESIGN_FUNCTIONS(ring_laser);

const imk_instrument imk_ring_laser_instrument = {
    IMKI_DESCRIBED(ring_laser),
    .title = "ring laser gyro",
    .technology = "RLG",
    .source =
        "Honeywell GG1320AN data sheet: bias stability 0.0035 deg/h, angle random walk 0.0035 "
        "deg/sqrt(h), scale factor 5 ppm; the rest chosen (ring_laser.h)",
    .sensor = IMK_GYRO,
    .cookie = COOKIE,
    .state_size = sizeof(imki_ring_laser),
    .init = init,
    .step = step,
    .observe = observe,
    .step_length = step_length,
};
