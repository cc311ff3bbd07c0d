/* SPDX-License-Identifier: Apache-2.0 */
/* Messages sensor_msgs/Imu read from bags of each container and compression, and written, millions
 * per second. One core; the bytes are in memory, those of databases in a file in /dev/shm or
 * TMPDIR. The yardstick of reading is what no reader can do without: unpacking the chunks and
 * adding up their CRC-32, where they have one. */
#include "bench.h"

#include "imukit/io.h"
#include "io/log/ros/log_mcap_internal.h"

#include <bzlib.h>
#include <lz4frame.h>
#include <unistd.h>
#include <zlib.h>
#include <zstd.h>

enum { ROWS = 300000, COLUMNS = 7, BLOCK = 8192, REPEATS = 5 };

static double data[COLUMNS][ROWS];
static imk_log_column columns[COLUMNS];

typedef struct bytes {
    uint8_t *at;
    size_t size, room;
} bytes;

static void stop(const char *what, const imk_error *error)
{
    fprintf(stderr, "bench_bags: %s%s%s\n", what, error ? ": " : "", error ? error->found : "");
    exit(1);
}

static uint8_t *add(bytes *to, const void *from, size_t size)
{
    if (to->size + size > to->room) {
        to->room = 2 * (to->size + size);
        to->at = realloc(to->at, to->room);
        if (!to->at)
            stop("no memory", NULL);
    }
    if (from)
        memcpy(to->at + to->size, from, size);
    to->size += size;
    return to->at + to->size - size;
}

static void make_rows(void)
{
    static const char *const names[COLUMNS] = {"time",    "gyro_x",  "gyro_y", "gyro_z",
                                               "accel_x", "accel_y", "accel_z"};
    uint64_t state = 1;
    for (int c = 0; c < COLUMNS; c++) {
        columns[c] = imk_record_column(names[c]);
        for (size_t i = 0; i < ROWS; i++) {
            state = state * 6364136223846793005u + 1442695040888963407u;
            data[c][i] = c == 0 ? (double)i * 0.005 : (double)(int64_t)state * 0x1p-63;
        }
    }
}

static void path_of(const char *ending, size_t size, char *path)
{
    const char *folder = access("/dev/shm", W_OK) == 0 ? "/dev/shm" : getenv("TMPDIR");
    snprintf(path, size, "%s/imukit_bench_%ld%s", folder ? folder : "/tmp", (long)getpid(), ending);
}

static void write_log(void *context)
{
    imk_log_writer *writer;
    imk_error error;
    const double *rows[COLUMNS];
    for (int c = 0; c < COLUMNS; c++)
        rows[c] = data[c];
    if (imk_log_create(context, COLUMNS, columns, IMK_LOG_SHORTEST, NULL, ROWS, &writer, &error) !=
            IMK_OK ||
        imk_log_write(writer, ROWS, rows, NULL) != IMK_OK ||
        imk_log_commit(writer, &error) != IMK_OK)
        stop("cannot write", &error);
}

static bytes load(const char *path)
{
    bytes file = {NULL, 0, 0};
    FILE *from = fopen(path, "rb");
    if (!from || fseek(from, 0, SEEK_END) != 0)
        stop(path, NULL);
    const long size = ftell(from);
    rewind(from);
    add(&file, NULL, (size_t)size);
    if (fread(file.at, 1, file.size, from) != file.size)
        stop(path, NULL);
    fclose(from);
    return file;
}

/* ---- chunks packed otherwise ---- */

static void pack(bytes *to, const char *packing, const uint8_t *from, size_t size)
{
    const size_t at = to->size, most = size + size / 8 + 65536;
    size_t packed = size;
    uint8_t *room = add(to, NULL, most);
    if (strcmp(packing, "lz4") == 0) {
        LZ4F_preferences_t how = {.frameInfo.blockSizeID = LZ4F_max1MB};
        packed = LZ4F_compressFrame(room, most, from, size, &how);
    } else if (strcmp(packing, "zstd") == 0) {
        packed = ZSTD_compress(room, most, from, size, 1);
    } else if (strcmp(packing, "bz2") == 0) {
        unsigned length = (unsigned)most;
        if (BZ2_bzBuffToBuffCompress((char *)room, &length, (char *)(uintptr_t)from, (unsigned)size,
                                     9, 0, 0) != BZ_OK)
            stop("bz2", NULL);
        packed = length;
    } else {
        memcpy(room, from, size);
    }
    to->size = at + packed;
}

/* A bag of ours with its chunks packed and without index. */
static bytes repack_bag(const bytes *bag, const char *packing)
{
    enum { HEAD = 13 + 8 + 4096 };
    bytes made = {NULL, 0, 0};
    add(&made, bag->at, HEAD);
    uint8_t *place = memmem(made.at, HEAD, "index_pos=", 10);
    memset(place + 10, 0, 8);
    for (size_t at = HEAD; at + 8 < bag->size;) {
        const uint32_t header = imki_get_u32(bag->at + at);
        const uint8_t *body = bag->at + at + 4 + header + 4;
        const uint32_t size = imki_get_u32(body - 4);
        if (memmem(bag->at + at + 4, header, "compression=none", 16)) {
            uint8_t fields[128], *end = fields + 4;
            end = imki_put_u32(end, (uint32_t)(12 + strlen(packing)));
            memcpy(end, "compression=", 12);
            memcpy(end + 12, packing, strlen(packing));
            end += 12 + strlen(packing);
            end = imki_put_u32(end, 4);
            memcpy(end, "op=\x05", 4);
            end = imki_put_u32(end + 4, 9);
            memcpy(end, "size=", 5);
            end = imki_put_u32(end + 5, size);
            imki_put_u32(fields, (uint32_t)(end - fields - 4));
            add(&made, fields, (size_t)(end - fields));
            add(&made, "\0\0\0", 4);
            const size_t before = made.size;
            pack(&made, packing, body, size);
            imki_put_u32(made.at + before - 4, (uint32_t)(made.size - before));
        }
        at += 4 + header + 4 + size;
    }
    return made;
}

/* An MCAP file of ours with its chunks packed otherwise and without summary. */
static bytes repack_mcap(const bytes *mcap, const char *packing)
{
    bytes made = {NULL, 0, 0}, plain = {NULL, 0, 0};
    add(&made, mcap->at, 8);
    for (size_t at = 8; mcap->at[at] != IMKI_MCAP_DATA_END;) {
        const uint8_t *record = mcap->at + at;
        const uint64_t size = imki_get_u64(record + 1);
        if (record[0] == IMKI_MCAP_CHUNK) {
            const uint8_t *members = record + 9;
            const uint64_t due = imki_get_u64(members + 16);
            plain.size = 0;
            add(&plain, NULL, due);
            ZSTD_decompress(plain.at, due, members + 28 + 4 + 4 + 8,
                            imki_get_u64(members + 28 + 8));
            const size_t before = made.size, length = strlen(packing);
            add(&made, record, 9 + 28);
            imki_put_u32(add(&made, NULL, 4), (uint32_t)length);
            add(&made, packing, length);
            add(&made, NULL, 8);
            const size_t data_at = made.size;
            pack(&made, packing, plain.at, due);
            imki_put_u64(made.at + data_at - 8, made.size - data_at);
            imki_put_u64(made.at + before + 1, made.size - before - 9);
        } else if (record[0] == IMKI_MCAP_HEADER) {
            add(&made, record, 9 + size);
        }
        at += 9 + size;
    }
    free(plain.at);
    uint8_t end[9 + 4] = {IMKI_MCAP_DATA_END, 4};
    add(&made, end, sizeof end);
    return made;
}

/* ---- reading ---- */

typedef struct input {
    const bytes *memory;
    const char *path;
} input;

static void read_log(void *context)
{
    static double block[COLUMNS][BLOCK];
    const input *from = context;
    imk_log_reader *reader;
    imk_error error;
    double *to[COLUMNS], sum = 0.0;
    size_t rows = 1, total = 0;
    for (int c = 0; c < COLUMNS; c++)
        to[c] = block[c];
    const imk_status status = from->path
                                  ? imk_log_open(from->path, NULL, &reader, &error)
                                  : imk_log_open_memory((const char *)from->memory->at,
                                                        from->memory->size, NULL, &reader, &error);
    if (status != IMK_OK)
        stop("cannot open", &error);
    while (rows > 0) {
        if (imk_log_read(reader, BLOCK, to, &rows, &error) != IMK_OK)
            stop("cannot read", &error);
        for (size_t i = 0; i < rows; i++)
            sum += block[6][i] - data[6][total + i];
        total += rows;
    }
    if (total != ROWS || sum != 0.0)
        stop("other rows were read than written", NULL);
    imk_log_close(reader);
}

/* Chunks unpacked and, of MCAP, summed. */
static void unpack_all(void *context)
{
    const bytes *file = context;
    const bool mcap = file->at[0] == 0x89;
    imki_ros_chunk chunk = {NULL};
    uint32_t sum = 0;
    for (size_t at = mcap ? 8 : 13 + 8 + 4096; at + 9 < file->size;) {
        const uint8_t *record = file->at + at, *body;
        uint64_t size, due;
        imki_log_piece packing = {"", ""};
        if (mcap) {
            at += 9 + imki_get_u64(record + 1);
            if (record[0] != IMKI_MCAP_CHUNK)
                continue;
            const uint32_t length = imki_get_u32(record + 9 + 28);
            due = imki_get_u64(record + 9 + 16);
            packing.begin = (const char *)record + 9 + 32;
            packing.end = packing.begin + length;
            body = record + 9 + 32 + length + 8;
            size = imki_get_u64(body - 8);
        } else {
            const uint32_t header = imki_get_u32(record);
            const uint8_t *name = memmem(record, header, "compression=", 12);
            body = record + 4 + header + 4;
            size = imki_get_u32(body - 4);
            due = imki_get_u32(record + 4 + header - 4);
            packing.begin = (const char *)name + 12;
            packing.end = packing.begin + imki_get_u32(name - 4) - 12;
            at += 4 + header + 4 + size;
        }
        bool intact = true;
        const imki_ros_packing kind = imki_ros_packing_named(packing);
        if (kind != IMKI_ROS_PLAIN)
            imki_ros_unpack(&chunk, kind, body, size, due, &intact, NULL);
        if (!intact)
            stop("a chunk is damaged", NULL);
        if (mcap)
            sum ^= (uint32_t)crc32_z(0, kind == IMKI_ROS_PLAIN ? body : chunk.bytes, due);
    }
    bench_use(&sum);
    imki_ros_chunk_free(&chunk);
}

static void row(const char *name, bench_work work, void *context, bench_work yardstick,
                void *yardstick_context)
{
    double ours, theirs;
    bench_compare(REPEATS, work, context, yardstick, yardstick_context, &ours, &theirs);
    bench_row_speed(name, ROWS * 1e-6 / ours, ROWS * 1e-6 / theirs, "M/s", "-", 1);
}

int main(void)
{
    static const char *const bag_packings[] = {"none", "lz4", "bz2"};
    static const char *const mcap_packings[] = {"", "lz4", "zstd"};
    char bag_path[64], mcap_path[64], db_path[64], name[64];
    bench_pin();
    make_rows();
    path_of(".bag", sizeof bag_path, bag_path);
    path_of(".mcap", sizeof mcap_path, mcap_path);
    path_of(".db3", sizeof db_path, db_path);
    puts("name,ours,yardstick,ratio,unit,isa,threads");
    row("bag_write", write_log, bag_path, NULL, NULL);
    row("mcap_zstd_write", write_log, mcap_path, NULL, NULL);
    row("rosbag2_write", write_log, db_path, NULL, NULL);
    bytes bag = load(bag_path), mcap = load(mcap_path);
    for (int i = 0; i < 6; i++) {
        const char *packing = i < 3 ? bag_packings[i] : mcap_packings[i - 3];
        bytes made = i < 3 ? repack_bag(&bag, packing) : repack_mcap(&mcap, packing);
        input from = {&made, NULL};
        snprintf(name, sizeof name, "%s_%s_read", i < 3 ? "bag" : "mcap",
                 packing[0] ? packing : "none");
        /* A bag without compression has nothing to unpack. */
        row(name, read_log, &from, i == 0 ? NULL : unpack_all, &made);
        free(made.at);
    }
    input from = {NULL, bag_path};
    row("bag_none_read_file", read_log, &from, NULL, NULL);
    from.path = db_path;
    row("rosbag2_read", read_log, &from, NULL, NULL);
    free(bag.at);
    free(mcap.at);
    remove(bag_path);
    remove(mcap_path);
    remove(db_path);
    return EXIT_SUCCESS;
}
