/* SPDX-License-Identifier: Apache-2.0 */
/* The stochastic terms of a model: a row each, at the end of the file of its generator. The
 * simulator, the drift, an alignment and a calibration plan walk the rows, so that a new term is a
 * row of the model's fields, a file here with its row, and its name in IMK_NOISE_TERM_LIST. */
#ifndef IMUKI_NOISE_TERMS_INTERNAL_H
#define IMUKI_NOISE_TERMS_INTERNAL_H

#include "generator_internal.h"
#include "imukit/model.h"

#include <stddef.h>

/* Where the numbers of a term stand: an axis of a triad, and an element of a list (else 0). */
typedef struct imki_term_place {
    const imk_triad *triad;
    int axis, instance;
} imki_term_place;

/* ---- samples: what the simulator runs ----
 *
 * A block of 512 samples is added in one of two ways. `blocks` adds those of one channel, one state
 * after another; what it needs of normals is drawn before, in one call for several terms. `across`
 * adds one state of each of several channels, for sequences that wait for their own sums. */

enum {
    IMKI_DRAWS_MAX = 3, /* of one state */
    IMKI_TOGETHER = 2,  /* states that one call of `blocks` takes at most */
};

/* Bytes of a state here: without the samples at its end, which only imk_…_add() hands out. */
#define IMKI_STATE_SIZE(type) offsetof(type, block)
enum { IMKI_STATE_MAX = sizeof(imk_flicker_state) }; /* of whole states */

typedef struct imki_generator {
    size_t state_size; /* IMKI_STATE_SIZE(), and how far states stand apart */
    /* @param state  a whole one */
    imk_status (*start)(void *state, imki_term_place place, double dt, imk_random random,
                        uint64_t stream);
    const char *field; /* what `start` refuses: key and number of the model */
    double (*refused)(imki_term_place place);
    size_t normals;                                                       /* of one state */
    size_t (*draws)(const void *state, double *normals, imki_draw *draw); /* @return how many */
    size_t together; /* states that gain by being added in one call */
    /* states, and their normals, stand one behind the other; normals may be overwritten */
    void (*blocks)(void *states, size_t count, imk_kernel kernel, double *normals, double *block);
    void (*across)(void *const *states, size_t count, double *const *blocks); /* instead, or NULL */
} imki_generator;

/* ---- processes: what the theory of drift and alignment takes ---- */

typedef enum imki_process_kind {
    IMKI_PROCESS_WHITE,       /* of density size^2 */
    IMKI_PROCESS_WALK,        /* from 0, K = size */
    IMKI_PROCESS_FIRST_ORDER, /* of variance size^2 and this correlation time */
    IMKI_PROCESS_SINE,        /* of amplitude size, this frequency, and random phase */
    IMKI_PROCESS_RESONANCE,   /* of variance size^2, this frequency and quality */
    IMKI_PROCESS_READING      /* errors of the readings of the integral, 1 sigma size [unit s] */
} imki_process_kind;

typedef struct imki_process {
    imki_process_kind kind;
    double size;
    double share;     /* of a variance or density of size^2; 1 save for flicker */
    double time;      /* [s] */
    double frequency; /* [Hz] */
    double q;
    bool matched; /* 2 v T is also the density of its samples at 0 Hz */
} imki_process;

enum { IMKI_PROCESSES_MAX = IMK_FLICKER_STAGES };

/* ---- the rows ---- */

typedef struct imki_noise_term {
    const char *path[2];                        /* below the sensor: gyro, accelerometer */
    const char *text[2];                        /* in words */
    uint16_t stream;                            /* IMK_TERM_… */
    int (*count)(const imk_noise *noise);       /* elements of a list; NULL: one */
    double (*strength)(imki_term_place place);  /* 0: not on this axis */
    const imki_generator *generator, *filtered; /* the second where the axis has a bandwidth */
    size_t (*processes)(imki_term_place place, double dt, imki_process *process);
    /* of a mean over a time: the Allan variance of a process, which is half the mean square
     * difference of two such means side by side */
    double (*mean_variance)(imki_term_place place, double dt, double time);
} imki_noise_term;

/* Of IMK_NOISE_TERM_LIST. */
#define COUNT(NAME, name, number) +1
enum { IMKI_NOISE_TERMS = IMK_NOISE_TERM_LIST(COUNT) };
#undef COUNT
extern const imki_noise_term *const imki_noise_terms[IMKI_NOISE_TERMS];

/* Elements of the term in a model: 1, or of its list. */
int imki_term_count(const imki_noise_term *term, const imk_noise *noise);
/* The generator of this axis. */
const imki_generator *imki_term_generator(const imki_noise_term *term, imki_term_place place);
/* One process of this size. @return 1 */
size_t imki_one_process(imki_process *process, imki_process_kind kind, double size);

/* Adds `count` samples, of a state whose blocks are made one at a time by `blocks`. */
void imki_add_generated(const imki_generator *generator, void *state, imk_random random,
                        imk_noise_block *block, size_t count, double *out);

#define ROW(NAME, name, number) extern const imki_noise_term imki_##name##_term;
IMK_NOISE_TERM_LIST(ROW)
#undef ROW
extern const imki_generator imki_filtered_white;

#endif
