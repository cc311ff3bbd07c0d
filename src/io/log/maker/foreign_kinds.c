/* SPDX-License-Identifier: Apache-2.0 */
/* What files are that imukit knows but does not read, and how their data come out of them. */
#include "foreign_kinds_internal.h"

#include <stdbool.h>
#include <stdio.h>
#include <string.h>

typedef struct foreign_kind {
    const char *begin; /* bytes at `place` */
    unsigned short size, place;
    bool (*check)(const unsigned char *bytes, size_t size); /* NULL: the bytes tell */
    const char *name;                                       /* behind "the file is " */
    const char *remedy;
} foreign_kind;

#define BYTES(text) text, sizeof text - 1
#define BY_PANDAS(function)                                                                        \
    "export it: python3 -c \"import pandas; pandas." function                                      \
    "('FILE').to_csv('NEW.csv', index=False)\""
#define SAVE_AS_CSV "save it as CSV in the spreadsheet program, and give that"
#define OTHER_LOG "give the log itself"

static bool holds(const unsigned char *bytes, size_t size, const char *text)
{
    const size_t length = strlen(text);
    for (size_t at = 0; at + length <= size; at++)
        if (memcmp(bytes + at, text, length) == 0)
            return true;
    return false;
}

/* A workbook is a zip with parts of these names. */
static bool is_workbook(const unsigned char *bytes, size_t size)
{
    return holds(bytes, size, "[Content_Types].xml") || holds(bytes, size, "xl/") ||
           holds(bytes, size, "opendocument.spreadsheet");
}

/* Xbus: FA FF, identifier, size of the data, data, a byte that makes the sum of all behind FA 0. */
static bool is_xbus(const unsigned char *bytes, size_t size)
{
    unsigned sum = 0;
    if (size < 5 || bytes[3] == 0xFF || size < 5u + bytes[3])
        return false;
    for (size_t i = 1; i < 5u + bytes[3]; i++)
        sum += bytes[i];
    return (sum & 0xFF) == 0;
}

/* A pickle of protocol 2 … 5 ends with a dot; its second byte is the protocol. */
static bool is_pickle(const unsigned char *bytes, size_t size)
{
    return size > 2 && bytes[1] >= 2 && bytes[1] <= 5 &&
           (bytes[2] == 0x95 || bytes[2] == ']' || bytes[2] == '}' || bytes[2] == 'c');
}

/* bzip2: "BZh", the size of the blocks, the first six digits of pi or, empty, of its root. */
static bool is_bzip2(const unsigned char *bytes, size_t size)
{
    return size >= 10 && bytes[3] >= '1' && bytes[3] <= '9' &&
           (memcmp(bytes + 4, "\x31\x41\x59\x26\x53\x59", 6) == 0 ||
            memcmp(bytes + 4, "\x17\x72\x45\x38\x50\x90", 6) == 0);
}

/* ---- texts that are no tables ---- */

typedef struct text {
    const char *at, *end;
} text;

static text text_of(const unsigned char *bytes, size_t size)
{
    const char *begin = (const char *)bytes;
    const size_t mark = size >= 3 && memcmp(begin, "\xEF\xBB\xBF", 3) == 0 ? 3 : 0;
    return (text){begin + mark, begin + size};
}

static text skip_blanks(text t)
{
    while (t.at < t.end && (*t.at == ' ' || *t.at == '\t' || *t.at == '\r' || *t.at == '\n'))
        t.at++;
    return t;
}

/* The character here, and then the next one that is not blank. */
static char take(text *t)
{
    *t = skip_blanks(*t);
    return t->at < t->end ? *t->at++ : '\0';
}

/* An object or an array of objects or arrays: {"…", [{, [[. */
static bool is_json(const unsigned char *bytes, size_t size)
{
    text t = text_of(bytes, size);
    const char first = take(&t), second = take(&t);
    return (first == '{' && second == '"') || (first == '[' && (second == '{' || second == '['));
}

/* An object in the first line, and one begins in the second. */
static bool is_json_lines(const unsigned char *bytes, size_t size)
{
    text t = text_of(bytes, size);
    if (!is_json(bytes, size) || take(&t) != '{')
        return false;
    const char *line = memchr(t.at, '\n', (size_t)(t.end - t.at));
    if (!line)
        return false;
    const char last = line[-1] == '\r' ? line[-2] : line[-1];
    t.at = line;
    return last == '}' && take(&t) == '{';
}

static bool is_xml(const unsigned char *bytes, size_t size)
{
    static const char *const beginnings[] = {"<?xml", "<!DOCTYPE", "<!doctype", "<!--", "<html"};
    const text t = skip_blanks(text_of(bytes, size));
    for (size_t i = 0; i < sizeof beginnings / sizeof beginnings[0]; i++) {
        const size_t length = strlen(beginnings[i]);
        if ((size_t)(t.end - t.at) >= length && memcmp(t.at, beginnings[i], length) == 0)
            return true;
    }
    return false;
}

/* A key alone in the first line, and below it one that is moved in: "header:", "  stamp:". */
static bool is_yaml(const unsigned char *bytes, size_t size)
{
    text t = text_of(bytes, size);
    if (t.end - t.at > 4 && memcmp(t.at, "---", 3) == 0)
        t = skip_blanks((text){t.at + 3, t.end});
    const char *line = memchr(t.at, '\n', (size_t)(t.end - t.at));
    const char *key = line;
    if (!line || line == t.at)
        return false;
    key -= line[-1] == '\r';
    if (key - t.at < 2 || key[-1] != ':' || line + 2 >= t.end || line[1] != ' ' || line[2] != ' ')
        return false;
    for (const char *c = t.at; c < key - 1; c++)
        if (*c == ',' || *c == ';' || *c == '\t' || *c == ' ')
            return false;
    const char *below = memchr(line + 1, '\n', (size_t)(t.end - line - 1));
    return memchr(line + 1, ':', (size_t)((below ? below : t.end) - line - 1)) != NULL;
}

#define UNPACK(command)                                                                            \
    "unpack it (" command ") and give what comes out; .gz and .zst are read as they are"

static const foreign_kind packings[] = {
    {BYTES("\xFD\x37zXZ\0"), 0, NULL, "compressed by xz", UNPACK("xz -dk FILE")},
    {BYTES("BZh"), 0, is_bzip2, "compressed by bzip2", UNPACK("bzip2 -dk FILE")},
    {BYTES("\x04\x22\x4D\x18"), 0, NULL, "compressed by lz4", UNPACK("lz4 -d FILE NEW")},
};

static const foreign_kind kinds[] = {
    {BYTES("PAR1"), 0, NULL, "a Parquet file", BY_PANDAS("read_parquet")},
    {BYTES("ARROW1"), 0, NULL, "an Arrow (Feather) file", BY_PANDAS("read_feather")},
    {BYTES("PK\x03\x04"), 0, is_workbook, "a workbook (.xlsx or .ods)", SAVE_AS_CSV},
    {BYTES("PK\x03\x04"), 0, NULL, "a zip archive",
     "unpack it (unzip FILE) and give what is in it"},
    {BYTES("\xD0\xCF\x11\xE0\xA1\xB1\x1A\xE1"), 0, NULL, "an office file (.xls, .doc)",
     SAVE_AS_CSV},
    {BYTES("ustar"), 257, NULL, "a tar archive", "unpack it (tar -xf FILE) and give what is in it"},
    {BYTES("H Product:Blackbox"), 0, NULL, "a Blackbox log (Betaflight, INAV)",
     "export it: blackbox_decode FILE, and give the .csv that it writes"},
    {BYTES("#ROSRECORD V1."), 0, NULL, "a ROS bag of a version before 2.0",
     "record it again with ROS 1: rosbag play FILE, beside rosbag record -a"},
    {BYTES("#ROSBAG V1."), 0, NULL, "a ROS bag of a version before 2.0",
     "record it again with ROS 1: rosbag play FILE, beside rosbag record -a"},
    {BYTES("TDSm"), 0, NULL, "a TDMS file (LabVIEW)",
     "export it: python3 -c \"import nptdms; nptdms.TdmsFile.read('FILE').as_dataframe()"
     ".to_csv('NEW.csv', index=False)\""},
    {BYTES("\xFA\xFF"), 0, is_xbus, "a log of Xsens messages (.mtb)",
     "export it as text with MT Manager, and give that"},
    {BYTES("ftyp"), 4, NULL, "a video (.mp4, .mov)",
     "export the readings that the camera stored in it as CSV, and give that"},
    {BYTES("WAVE"), 8, NULL, "a sound (.wav)",
     "export its channels as CSV, and state the rate by --rate"},
    {BYTES("\x80"), 0, is_pickle, "a pickle of Python",
     "write its arrays as CSV or .npy with the program that made it"},
    {BYTES("RDX2\n"), 0, NULL, "a file of R (.rda)",
     "export it in R: load('FILE'), then write.csv(NAME, 'NEW.csv', row.names=FALSE)"},
    {BYTES("RDX3\n"), 0, NULL, "a file of R (.rda)",
     "export it in R: load('FILE'), then write.csv(NAME, 'NEW.csv', row.names=FALSE)"},
    {BYTES("X\n\0\0\0"), 0, NULL, "a file of R (.rds)",
     "export it in R: write.csv(readRDS('FILE'), 'NEW.csv', row.names=FALSE)"},
    {BYTES("\x89PNG\r\n"), 0, NULL, "an image (.png)", OTHER_LOG},
    {BYTES("\xFF\xD8\xFF"), 0, NULL, "an image (.jpg)", OTHER_LOG},
    {BYTES("%PDF-"), 0, NULL, "a PDF document", OTHER_LOG},
    {BYTES(""), 0, is_json_lines, "JSON with an object in each line",
     "write it as CSV with a column for each number; objects without lists: python3 -c \"import "
     "json, pandas; pandas.json_normalize([json.loads(l) for l in open('FILE')])"
     ".to_csv('NEW.csv', index=False)\""},
    {BYTES(""), 0, is_json, "JSON",
     "write it as CSV with a column for each number; an array of objects without lists: python3 -c "
     "\"import json, pandas; pandas.json_normalize(json.load(open('FILE')))"
     ".to_csv('NEW.csv', index=False)\""},
    {BYTES(""), 0, is_xml, "XML or HTML",
     "write its numbers as CSV, with a column for each, in the program that made it"},
    {BYTES(""), 0, is_yaml, "YAML",
     "write its numbers as CSV, with a column for each; of a topic of ROS, record a bag (ros2 bag "
     "record TOPIC) and give that"},
};

static bool is_kind(const foreign_kind *kind, const char *begin, size_t size)
{
    const size_t place = kind->place;
    return size >= place + kind->size && memcmp(begin + place, kind->begin, kind->size) == 0 &&
           (!kind->check || kind->check((const unsigned char *)begin, size));
}

static imk_status refuse(const foreign_kind *kind, size_t count, const char *begin, size_t size,
                         imk_error *error)
{
    for (size_t i = 0; i < count; i++) {
        char found[96];
        if (!is_kind(&kind[i], begin, size))
            continue;
        snprintf(found, sizeof found, "the file is %s, which imukit does not read", kind[i].name);
        return imk_error_set(error, IMK_ERROR_UNSUPPORTED, "", found, kind[i].remedy);
    }
    return IMK_OK;
}

imk_status imki_foreign_kind_refuse(const char *begin, size_t size, imk_error *error)
{
    return refuse(kinds, sizeof kinds / sizeof kinds[0], begin, size, error);
}

imk_status imki_foreign_packing_refuse(const char *begin, size_t size, imk_error *error)
{
    return refuse(packings, sizeof packings / sizeof packings[0], begin, size, error);
}
