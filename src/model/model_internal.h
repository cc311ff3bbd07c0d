/* SPDX-License-Identifier: Apache-2.0 */
/* What the files of the model share beside the schema. */
#ifndef IMUKI_MODEL_INTERNAL_H
#define IMUKI_MODEL_INTERNAL_H

/* "IMK" and the number of the struct's layout: tells a model from uninitialised memory. */
#define IMKI_MODEL_COOKIE 0x494D4B01u

#endif
