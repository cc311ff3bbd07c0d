/* SPDX-License-Identifier: Apache-2.0 */
/* The words of a name: it is divided at signs and capitals, "imu0.AngularVelocity_x" is imu0,
 * angular, velocity, x. */
#ifndef IMUKIT_LOG_WORDS_INTERNAL_H
#define IMUKIT_LOG_WORDS_INTERNAL_H

#include <stdbool.h>
#include <stddef.h>

enum { IMKI_LOG_WORDS_MOST = 12, IMKI_LOG_WORD_SIZE = 24 };

typedef struct imki_log_words {
    size_t count;
    bool overflow;                                      /* more, or a longer one, than a name has */
    char word[IMKI_LOG_WORDS_MOST][IMKI_LOG_WORD_SIZE]; /* in small letters */
} imki_log_words;

void imki_log_words_divide(const char *name, imki_log_words *w);

/* How many words from `first` on are those of a phrase; 0: others. */
size_t imki_log_words_match(const imki_log_words *w, size_t first, size_t end, const char *phrase);

/* Are words first … end - 1 this phrase? */
bool imki_log_words_are(const imki_log_words *w, size_t first, size_t end, const char *phrase);

#endif
