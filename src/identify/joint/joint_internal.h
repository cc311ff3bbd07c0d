/* SPDX-License-Identifier: Apache-2.0 */
/* Parts of the joint estimate from several records. */
#ifndef IMUKIT_JOINT_INTERNAL_H
#define IMUKIT_JOINT_INTERNAL_H

#include "identify/likelihood/identify_internal.h"
#include "imukit/identify_joint.h"

/* joint_agreement.c: each record alone against the joint fit of `w`, whose trial and chosen it
 * uses, and `bands` for one record. Values in the unit of the records. */
void imki_joint_agreement(imki_work *w, const imk_identification *joint, size_t count,
                          const imk_spectral_summary *const *summaries, imki_bands *bands,
                          imk_joint_agreement *agreement);

#endif
