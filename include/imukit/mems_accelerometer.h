/* SPDX-License-Identifier: Apache-2.0 */
/** @file mems_accelerometer.h
 *  MEMS accelerometer: a proof mass on springs between electrodes, which sense its position and, in
 *  a closed loop, hold it in place.
 *
 *      X'' = -(w0/Q) c(z) X' - w0^2 (X + q X^2 + r X^3) + E(z) - a + n,      z = X + offset
 *
 *  X is the displacement of the mass in the case from the rest position of its springs, and z that
 *  from the middle of the gap. a is the specific force along the input axis (which the suspension's
 *  tilt turns), plus the bias force. n is the thermal noise of the damping, one-sided density
 *  sqrt(4 k T w0/(m Q)). Electrodes at the distances gap - z (plus) and gap + z (minus) pull with
 *
 *      E = eps A/(2 m) [ V+^2/(gap - z)^2 - V-^2/(gap + z)^2 ]                          [m/s^2]
 *
 *  - open loop: V+ = V- = V, the rms voltage of the sensing carrier (single: plus only);
 *  - analog loop: plates at +V and -V, the mass at the control voltage u: V+ = V - u, V- = V + u;
 *  - sigma-delta: V of the carrier on both and, for a whole clock, the feedback voltage on one
 *    plate, chosen by the sign of the compensated position.
 *
 *  Input axis x; y and z are across it, right-handed; only the tilts distinguish them. Rotation of
 *  the case acts on the mass by w^2 X, some 1e-7 of its stiffness at 1000 deg/s, which is left out.
 *
 *  Output 0 is the specific force [m/s^2], the mean over the sample. It is calibrated at the
 *  design's temperature for small inputs about zero; `reduce` states the remaining errors. */
#ifndef IMUKIT_MEMS_ACCELEROMETER_H
#define IMUKIT_MEMS_ACCELEROMETER_H

#include "imukit/instrument.h"

IMK_BEGIN_C

typedef enum imk_mems_loop {
    IMK_MEMS_OPEN = 0,    /**< open loop: the displacement gives the reading */
    IMK_MEMS_ANALOG,      /**< a controller's force, proportional to a voltage, holds the mass */
    IMK_MEMS_SIGMA_DELTA, /**< one of two forces is applied in each clock period */
} imk_mems_loop;

typedef enum imk_mems_plates { IMK_MEMS_DOUBLE = 0, IMK_MEMS_SINGLE } imk_mems_plates;

/** Output of the amplifier for the capacitances C+ and C-. A single plate is compared with a fixed
 *  capacitor equal to its value at rest. */
typedef enum imk_mems_pickoff {
    IMK_MEMS_RATIO = 0, /**< (C+ - C-)/(C+ + C-): linear between two plates */
    IMK_MEMS_DIFFERENCE /**< C+ - C- */
} imk_mems_pickoff;

/** A design. Start from imk_mems_accelerometer_default(), _analog() or _sigma_delta(). SI. */
typedef struct imk_mems_accelerometer {
    uint32_t cookie;
    imk_mems_loop loop;
    double temperature; /**< temperature of calibration and of the noise [K] */

    double mass;               /**< [kg] */
    double frequency;          /**< of the mass on its springs alone [Hz] */
    double quality;            /**< Q of the mass in the middle of the gap [1] */
    bool squeeze_film;         /**< damping grows with the displacement, see the function below */
    double spring_quadratic;   /**< q [1/m] */
    double spring_cubic;       /**< r [1/m^2] */
    double spring_temperature; /**< relative change of the stiffness [1/K] */
    double tilt_y, tilt_z;     /**< tilt of the suspension's compliant axis towards y and z [rad] */

    imk_mems_plates plates;
    double area;         /**< of one plate [m^2] */
    double gap;          /**< [m] */
    double offset;       /**< offset of the springs' rest position from the middle of the gap [m] */
    double stop;         /**< |z| at the stops as a part of the gap, < 1 */
    double restitution;  /**< of an impact on a stop, 0 ... 1 */
    double voltage;      /**< V, rms [V] */
    double voltage_rate; /**< rate of increase of V, for experiments on pull-in [V/s] */
    double voltage_temperature; /**< relative change of all voltages [1/K] */

    imk_mems_pickoff pickoff;
    double pickoff_noise;  /**< one-sided density, as displacement [m/sqrt(Hz)] */
    double pickoff_offset; /**< displacement z that a loop takes for zero [m] */

    double feedback_voltage; /**< analog: largest control voltage; sigma-delta: of the plates [V] */
    double bandwidth;        /**< analog: f_c, see imk_mems_accelerometer_gains() [Hz] */
    double damping;          /**< analog: zeta [1] */
    double reset;            /**< analog: f_i of the integral part; 0: none [Hz] */
    double amplifier;        /**< analog: bandwidth of each of the two stages before it [Hz] */
    double clock;            /**< sigma-delta [Hz]; raised to a whole multiple of the sample rate */
    double lead;             /**< sigma-delta: c of the compensator 1 + c (1 - z^-1) [clocks] */
    double integral;         /**< sigma-delta: i of a further term i/(1 - z^-1) [1/clock] */

    double output_bandwidth;   /**< second order, damping 1/sqrt(2); 0: none [Hz] */
    double range;              /**< limit of the output; 0: none [m/s^2] */
    double resolution;         /**< step of the output, 0: none [m/s^2] */
    double gain_repeatability; /**< 1 sigma, relative, per run */

    double bias;               /**< error force on the mass, as specific force [m/s^2] */
    double bias_repeatability; /**< 1 sigma per run [m/s^2] */
    double bias_instability;   /**< B of flicker noise [m/s^2] */
    double bias_temperature;   /**< [m/s^2/K] */
} imk_mems_accelerometer;

/** Open loop, after the Safran Colibrys MS1005, +-5 g [MS1000].
 *
 *  Published: range, bias repeatability 0.6 mg, in-run bias stability 7.5 ug (taken as the Allan
 *  floor, B = 7.5/0.664 ug), noise 17 ug/sqrt(Hz) (one-sided), scale factor error 120 ppm (taken as
 *  repeatability), misalignment at most 10 mrad (5 mrad taken), nonlinearity 0.3 % of full scale
 *  (0.17 % follows here from the carrier's force). Chosen, since not published: mass, resonance, Q,
 *  plates, voltages, temperature coefficient of the bias, and a 200 Hz output filter; the springs'
 *  -64 ppm/K is that of silicon's modulus; the amplifier's noise is the part of the published noise
 *  that is left. */
IMK_API imk_mems_accelerometer imk_mems_accelerometer_default(void);
/** The same mass in an analog force loop of 4 kHz with 4 V on the plates (chosen). */
IMK_API imk_mems_accelerometer imk_mems_accelerometer_analog(void);
/** The same mass in a sigma-delta loop: 100 kHz, 7 V, with an integral term (chosen). */
IMK_API imk_mems_accelerometer imk_mems_accelerometer_sigma_delta(void);

/** Check a design: fields in their ranges, and
 *  - the plates do not pull in without an input; the springs' rest position is within the stops;
 *  - a closed loop has two plates; its force, or the travel of an open loop, covers `range`, and
 *    the bias with six times its repeatability;
 *  - the analog loop is stable by Routh's criterion, at rest and at full scale;
 *  - the limit cycle of the sigma-delta loop exists, is no longer than 16 clocks and within half
 *    the stops.
 *  @return IMK_OK, IMK_ERROR_UNINITIALISED, _NOT_FINITE, _RANGE, _CONFLICT */
IMK_API imk_status imk_mems_accelerometer_validate(const imk_mems_accelerometer *design,
                                                   imk_error *error);

/** The error model. One axis; valid designs only.
 *
 *  | term | open loop | closed loops |
 *  |---|---|---|
 *  | scale factor over temperature | -(w0^2 s - 2 we^2 v)/(w0^2 - we^2) | -2v |
 *  | K2, K3 | series of springs, E and pickoff | of E in u, where the null is off the middle |
 *  | white noise | Brownian, (w0^2 - we^2) times the pickoff's | and quantization (sigma-delta) |
 *  | range | travel to the stops | force |
 *
 *  A sigma-delta loop without integral term has a dead band as long as its noise is too small to
 *  break the limit cycle (four standard deviations within its margin); with more noise it has the
 *  finite gain of imk_mems_quantizer instead, a scale factor error -1/(1 + gain).
 *
 *  The mean of a loop's force over a sample differs from the input by the change of the mass's
 *  momentum. Without an output filter this is reading noise of the rms velocity of the mass; an
 *  output filter removes most of it, and then none is stated.
 *
 *  s and v are the relative temperature coefficients of springs and voltages, we^2 the softening.
 *  `bandwidth` and `damping` are those of the second-order filter with the -3 dB point and the
 *  delay of the whole chain. */
IMK_API void imk_mems_accelerometer_reduce(const imk_mems_accelerometer *design, imk_model *model);

/* ---- closed forms ---------------------------------------------------------------------------- */

/** Thermal noise as specific force, one-sided: sqrt(4 k T w0/(m Q)) [m/s^2/sqrt(Hz)]
 * [GABRIELSON1993, eq. 6]. */
IMK_API double imk_mems_accelerometer_brownian(const imk_mems_accelerometer *design);
/** Softening by the carrier in the middle of the gap: 2 eps A V^2/gap^3 (single-sided half of it)
 *  [N/m]. */
IMK_API double imk_mems_accelerometer_softening(const imk_mems_accelerometer *design);
/** Pull-in voltage, at which the mass has no equilibrium without input, for linear springs [V]:
 *  single V^2 = 8 k (gap - offset)^3/(27 eps A), the plate being nearer by the offset; double,
 *  resting in the middle, V^2 = k gap^3/(2 eps A) [SENTURIA2001, ch. 6]. */
IMK_API double imk_mems_accelerometer_pull_in(const imk_mems_accelerometer *design);
/** Displacement for a constant input, softening included: 1/(w0^2 - we^2) [m/(m/s^2)]. */
IMK_API double imk_mems_accelerometer_sensitivity(const imk_mems_accelerometer *design);
/** Damping at z over damping in the middle: for a thin film squeezed between parallel plates, whose
 *  force is ~ 1/distance^3 on each side [SENTURIA2001, ch. 13]: (1 + 3 s^2)/(1 - s^2)^3, s = z/gap;
 *  with one plate 1/(1 - s)^3. 1 when squeeze_film is off. */
IMK_API double imk_mems_accelerometer_damping(const imk_mems_accelerometer *design, double z);
/** Largest specific force a loop can balance [m/s^2]: analog 2 eps A V U/(m gap^2), sigma-delta
 *  eps A U^2/(2 m gap^2), U the feedback voltage; the travel limit of an open loop. */
IMK_API double imk_mems_accelerometer_limit(const imk_mems_accelerometer *design);
/** Rectification of an open loop: bias shift over the mean square of a vibration at `frequency`, K2
 *  |H|^2 with H the response of the mass [1/(m/s^2)]. */
IMK_API double imk_mems_accelerometer_rectification(const imk_mems_accelerometer *design,
                                                    double frequency);

/** Gains of the analog controller, acceleration of the mass per displacement: proportional
 *  wc^2 - wk^2, derivative 2 zeta wc - w0/Q (not below 0), integral wi wc^2; wk^2 is the stiffness
 *  left after softening by the carrier. */
typedef struct imk_mems_gains {
    double proportional; /**< [1/s^2] */
    double derivative;   /**< [1/s] */
    double integral;     /**< [1/s^3] */
} imk_mems_gains;
/** The gains of a valid design with an analog loop. */
IMK_API imk_mems_gains imk_mems_accelerometer_gains(const imk_mems_accelerometer *design);

/** The limit cycle of a sigma-delta loop without noise, input and integral term: `half_period`
 *  clocks of each force in turn. Of all possible cycles, this one withstands the largest
 *  disturbance. A constant input shifts all positions equally, by input/stiffness. As long as no
 *  sign at a clock changes, the bits do not change, and the input is not sensed: dead_zone =
 *  stiffness * the smallest |compensated position| at a clock. After a sudden input the loop may be
 *  caught in another cycle. Noise frees it unless six standard deviations of the compensated
 *  position are less than that margin; only then does `reduce` state the dead zone. */
typedef struct imk_mems_limit_cycle {
    int half_period;  /**< [clocks]; 0: no symmetric cycle up to 32 clocks each */
    double amplitude; /**< largest |z| at a clock [m] */
    double dead_zone; /**< half width [m/s^2] */
} imk_mems_limit_cycle;
/** The limit cycle of a valid design with a sigma-delta loop. */
IMK_API imk_mems_limit_cycle
imk_mems_accelerometer_limit_cycle(const imk_mems_accelerometer *design);

/** A sigma-delta loop with noise, with its quantizer replaced by a gain and white noise: for a
 *  normal input of standard deviation s the gain is sqrt(2/pi)/s and the variance of the noise
 *  1 - 2/pi [ARDALAN1987]; s follows from the linear loop, by iteration. */
typedef struct imk_mems_quantizer {
    double deviation;    /**< s of the compensated position [m] */
    double gain;         /**< loop gain at frequency 0 without integral term [1] */
    double velocity;     /**< rms velocity of the mass at the clocks [m/s] */
    double quantization; /**< two-sided density of the shaped quantization noise at low frequency,
                            as specific force [m/s^2/sqrt(Hz)] */
} imk_mems_quantizer;
/** The quantizer of a valid design with a sigma-delta loop. */
IMK_API imk_mems_quantizer imk_mems_accelerometer_quantizer(const imk_mems_accelerometer *design);

/** The instrument. The full level treats the linear part exactly (mass, softening at rest,
 *  controller, filters and their noise). It treats the other forces by symmetric splitting, with an
 *  error of second order in the step, times the part that is not linear. At the default step (25 to
 *  a cycle of springs or loop; sigma-delta: at most a clock) that is 0.05 ppm of full scale for the
 *  default design; fewer than 16 are refused. The slow level is the static nonlinearity followed by
 *  the linear response, exact at the sampling rate; it has no limit cycle, dead zone or
 *  quantization noise. */
IMK_API extern const imk_instrument imk_mems_accelerometer_instrument;

IMK_END_C
#endif
