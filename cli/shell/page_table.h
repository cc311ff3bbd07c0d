/* SPDX-License-Identifier: Apache-2.0 */
/* A text table on an HTML page, and the page as a file. */
#ifndef IMUKIT_PAGE_TABLE_H
#define IMUKIT_PAGE_TABLE_H

#include "text_table.h"

#include "imukit/model.h"
#include "imukit/report.h"

/* A model file as text, or why there is none. */
void page_put_model(imk_page *page, const char *title, const imk_model *model);

/* Nothing for a table without rows. */
void page_put_table(imk_page *page, const text_table *table);

/* Write the page and free it. @return -1 or the exit code, the message printed */
int page_write(imk_page *page, const char *path);

#endif
