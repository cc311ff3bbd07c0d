/* SPDX-License-Identifier: Apache-2.0 */
/** @file magnetometer.h
 *  Calibration of a magnetometer: hard iron, soft iron, and how its axes stand to those of the
 *  accelerometers beside it.
 *
 *      m = h + A u + noise,   |u| = F,   u . f = -F sin(dip)
 *
 *  with the reading m, hard iron h, the matrix A of scale factors, soft iron and alignment, the
 *  field u of the Earth in body axes, its modulus F, and f, the direction of the specific force at
 *  rest: away from the centre of the Earth. |u| = F determines h and A up to a rotation; the dip,
 *  which is the same in all attitudes, determines the rotation. Without the true F, the scale of A
 *  is a convention: its determinant is 1. All attitudes are unknown.
 *
 *  The fit is by maximum likelihood, without the bias of algebraic fits. Attitudes that do not fit
 *  the others are refused, and sigmas are multiplied by the factor that the residuals show. Method:
 *  docs/theory/calibration.md. */
#ifndef IMUKIT_MAGNETOMETER_H
#define IMUKIT_MAGNETOMETER_H

#include "imukit/axes_mending.h"
#include "imukit/calibration.h"

IMK_BEGIN_C

/** The parameters, in the order of values and covariance: hard iron x, y, z [T]; A, row by row [1];
 *  the field [T]; the sine of the dip [1]. */
enum {
    IMK_MAGNETOMETER_RESPONSE = 3,
    IMK_MAGNETOMETER_FIELD = 12,
    IMK_MAGNETOMETER_DIP = 13,
    IMK_MAGNETOMETER_PARAMETERS = 14,
    IMK_MAGNETOMETER_ADVICE = 3
};

/** The mean of some readings in one attitude. */
typedef struct imk_magnetometer_observation {
    double reading[3]; /**< [T] */
    double sigma[3];   /**< [T], > 0 */
    double up[3];    /**< direction of the specific force at rest, body axes, unit norm; zeros: not
                          known */
    double up_sigma; /**< 1 sigma of its tilt about each axis [rad]; 0: exact */
    int record;      /**< the caller's: index of the record, and its samples */
    size_t begin, end;
    /* Filled by imk_magnetometer_solve(): */
    double field[3];    /**< u, body axes [T] */
    double residual[2]; /**< of |u|, and of the field along `up` [T]; NaN: no `up` */
    double distance;    /**< root mean square of residual/sigma (factor included) */
    double weight;      /**< 1 used … 0 refused */
    double adjusted[3]; /**< reading as fitted [T] */
    double leverage;    /**< share of the residuals that the fit takes away */
} imk_magnetometer_observation;

/** The problem. Start from imk_magnetometer_default(). */
typedef struct imk_magnetometer {
    uint32_t cookie;
    imk_triad_frame frame; /**< convention that fixes the rotation of A if no observation has `up`;
                                default symmetric; IMK_FRAME_REFERENCE is taken as symmetric */
    double field, field_sigma; /**< F with its 1 sigma [T]; default NaN: not known */
    bool robust;               /**< refuse outliers; default true */
    bool series; /**< the observations follow each other in time, so that neighbours may have the
                      same error; default false */
    /** Calibration of the accelerometers that `up` comes from, whose uncertainty is included; NULL:
     *  none. */
    const imk_calibration_result *accel;
    size_t count;
    imk_magnetometer_observation *observation; /**< the caller's */
} imk_magnetometer;
/** Nothing observed, nothing known. */
IMK_API imk_magnetometer imk_magnetometer_default(void);

/** The solution. About 13 kB. */
typedef struct imk_magnetometer_result {
    bool aligned;     /**< `up` was known: A is in the axes of the accelerometers */
    bool field_known; /**< else the scale of A is a convention */
    double value[IMK_MAGNETOMETER_PARAMETERS]; /**< the dip is NaN if not aligned */
    double sigma[IMK_MAGNETOMETER_PARAMETERS];
    double covariance[IMK_MAGNETOMETER_PARAMETERS * IMK_MAGNETOMETER_PARAMETERS]; /**< row-major */
    double freedom;                        /**< degrees of freedom of the sigmas */
    size_t parameter_count;                /**< number of independent parameters */
    size_t equations, refused;             /**< scalar observations; observations without weight */
    double chi_square, degrees_of_freedom; /**< by the stated sigmas, of what is not refused */
    double factor; /**< of the sigmas: sqrt(chi_square/degrees_of_freedom) */
    double added;  /**< part that was added to each sigma instead, where residuals are far above
                        the noise [T] */
    double serial; /**< variance of a mean over that of independent observations; 1: they are */
    double rms[2]; /**< of the residuals of |u|, and along `up` [T] */
    int nearest;   /**< number of the signed permutation nearest to A, imk_signed_axes_of(): not 0
                        if the axes are not those of the accelerometers */
    double nearest_angle; /**< rotation between that permutation and A [rad] */
    double spread;    /**< smallest eigenvalue of the covariance of the directions of the field: 1/3
                           at best, 0 if their tips are in one plane */
    double normal[3]; /**< across this plane, body axes */
    double advice[IMK_MAGNETOMETER_ADVICE][3]; /**< directions of the field, body axes, that would
                                                    tell most beside what there is */
    /** Covariance with the parameters of the accelerometers' calibration, row of each parameter. */
    double cross[IMK_MAGNETOMETER_PARAMETERS][IMK_CORRELATED_MAX];
    int iterations;
} imk_magnetometer_result;

/** Estimate. The outputs of the observations are filled.
 *  @param scratch  room for `count` numbers
 *  @return IMK_ERROR_TOO_SHORT (value: equations, limit: how many are needed), IMK_ERROR_SINGULAR
 *          (the attitudes do not determine the parameters), IMK_ERROR_NO_CONVERGENCE; with these
 *          two spread, normal and advice are filled, and nothing else; IMK_ERROR_RANGE (field:
 *          "field", "sigma", "reading"), IMK_ERROR_UNINITIALISED, IMK_ERROR_ARGUMENT */
IMK_API imk_status imk_magnetometer_solve(const imk_magnetometer *problem,
                                          imk_magnetometer_result *result, double *scratch,
                                          imk_error *error);

/** How a record of a magnetometer looks. */
typedef struct imk_magnetometer_record {
    size_t updates;      /**< rows that differ from the row before, and the first */
    size_t rows;         /**< rows that are numbers */
    bool stuck[3];       /**< the axis never changes */
    double saturated[3]; /**< reading at which the axis stays for 20 updates or more, its largest or
                              smallest [T]; 0: none */
    double noise[3];     /**< 1 sigma of one update, from neighbours [T] */
    double step[3];      /**< smallest difference of neighbours that differ [T] */
} imk_magnetometer_record;
/** Look at a record with a magnetometer. */
IMK_API imk_magnetometer_record imk_magnetometer_look(const imk_test_record *record);

/** Mean of a stretch at rest. Repeated rows and coarse steps are allowed for.
 *  @param look  of the whole record
 *  @return false: fewer than two readings that are numbers */
IMK_API bool imk_magnetometer_rest(const imk_test_record *record,
                                   const imk_magnetometer_record *look, size_t begin, size_t end,
                                   imk_magnetometer_observation *observation);
/** One noise for all means at rest, in the place of that of each: n of its samples count as one
 *  says for all. */
IMK_API void imk_magnetometer_pool(size_t count, imk_magnetometer_observation *observation);
/** Readings of a record of a unit in motion: short means, over which the field turns by 0.02 rad at
 *  most, or single updates; at most `capacity`, evenly spread.
 *  @return their number */
IMK_API size_t imk_magnetometer_motion(const imk_test_record *record, size_t capacity,
                                       imk_magnetometer_observation *observation);

IMK_END_C
#endif
