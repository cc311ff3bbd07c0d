/* SPDX-License-Identifier: Apache-2.0 */
/* Reading flight logs from memory: sensor_combined of a ULog, and IMU of a DataFlash log, each
 * after another message of the same size that is of no interest. The yardstick is a loop that knows
 * the one layout beforehand and looks at nothing else than the header of each message. */
#include "bench.h"

#include "imukit/log.h"

enum { ROWS = 1000000, COLUMNS = 12, REPETITIONS = 9, BLOCK = 1 << 16 };

typedef struct flight_log {
    char *bytes;
    size_t size, begin; /* begin: of the messages that are data */
    const char *topic;
    size_t (*plain)(const struct flight_log *log, double *const *columns);
    double *columns[COLUMNS];
    size_t rows; /* of the last run */
} flight_log;

static void put(flight_log *l, const void *bytes, size_t size)
{
    memcpy(l->bytes + l->size, bytes, size);
    l->size += size;
}

static void put_ulog_message(flight_log *l, char kind, const void *body, size_t size)
{
    const char header[3] = {(char)(size & 0xFF), (char)(size >> 8), kind};
    put(l, header, 3);
    put(l, body, size);
}

static void put_number(char *body, size_t place, const void *number, size_t size)
{
    memcpy(body + place, number, size);
}

/* Time, three rates, interval, relative time, three forces, interval, clipping. */
static flight_log make_ulog(void)
{
    static const char head[] = "ULog\1\x12\x35\1\0\0\0\0\0\0\0";
    static const char formats[2][300] = {
        "sensor_combined:uint64_t timestamp;float[3] gyro_rad;uint32_t gyro_integral_dt;int32_t "
        "accelerometer_timestamp_relative;float[3] accelerometer_m_s2;uint32_t "
        "accelerometer_integral_dt;uint8_t accelerometer_clipping;uint8_t[3] _padding0;",
        "other:uint64_t timestamp;float[9] x;uint8_t y;"};
    flight_log l = {.bytes = calloc(ROWS + 100, 100), .topic = "sensor_combined"};
    if (!l.bytes)
        exit(EXIT_FAILURE);
    put(&l, head, 16);
    for (int i = 0; i < 2; i++)
        put_ulog_message(&l, 'F', formats[i], strlen(formats[i]));
    put_ulog_message(&l, 'A', "\0\0\0sensor_combined", 18);
    put_ulog_message(&l, 'A', "\0\1\0other", 8);
    l.begin = l.size;
    for (int k = 0; k < ROWS; k++) {
        char body[47] = {0};
        const uint64_t time = 1000000 + 1000 * (uint64_t)k;
        put_number(body, 2, &time, 8);
        for (size_t axis = 0; axis < 3; axis++) {
            const float rate = (float)k / 1024, force = (float)k / 512;
            put_number(body, 10 + 4 * axis, &rate, 4);
            put_number(body, 30 + 4 * axis, &force, 4);
        }
        put_ulog_message(&l, 'D', body, 47);
        body[0] = 1;
        put_ulog_message(&l, 'D', body, 47);
    }
    return l;
}

static size_t plain_ulog(const flight_log *l, double *const *columns)
{
    size_t rows = 0;
    for (const char *at = l->bytes + l->begin; at < l->bytes + l->size;) {
        uint16_t size, number;
        uint64_t time;
        float value[9];
        memcpy(&size, at, 2);
        memcpy(&number, at + 3, 2);
        if (at[2] == 'D' && number == 0) {
            memcpy(&time, at + 5, 8);
            memcpy(value, at + 13, sizeof value);
            columns[0][rows] = (double)time * 1e-6;
            for (int i = 0; i < 9; i++)
                columns[1 + i][rows] = (double)value[i];
            rows++;
        }
        at += 3 + size;
    }
    return rows;
}

static void put_fmt(flight_log *l, int number, size_t length, const char *name, const char *types,
                    const char *labels)
{
    char body[89] = {(char)0xA3, (char)0x95, (char)128, (char)number, (char)length};
    memcpy(body + 5, name, strlen(name));
    memcpy(body + 9, types, strlen(types));
    memcpy(body + 25, labels, strlen(labels));
    put(l, body, sizeof body);
}

static flight_log make_dataflash(void)
{
    flight_log l = {.bytes = calloc(ROWS + 100, 110), .topic = "IMU"};
    if (!l.bytes)
        exit(EXIT_FAILURE);
    put_fmt(&l, 128, 89, "FMT", "BBnNZ", "Type,Length,Name,Format,Columns");
    put_fmt(&l, 20, 54, "IMU", "QBffffffIIfBBHH",
            "TimeUS,I,GyrX,GyrY,GyrZ,AccX,AccY,AccZ,EG,EA,T,GH,AH,GHz,AHz");
    put_fmt(&l, 21, 54, "OTHR", "QBffffffIIfBBHH",
            "TimeUS,I,GyrX,GyrY,GyrZ,AccX,AccY,AccZ,EG,EA,T,GH,AH,GHz,AHz");
    l.begin = l.size;
    for (int k = 0; k < ROWS; k++) {
        char body[54] = {(char)0xA3, (char)0x95, 20};
        const uint64_t time = 1000000 + 1000 * (uint64_t)k;
        put_number(body, 3, &time, 8);
        for (size_t i = 0; i < 6; i++) {
            const float value = (float)k / 1024;
            put_number(body, 12 + 4 * i, &value, 4);
        }
        put(&l, body, sizeof body);
        body[2] = 21;
        put(&l, body, sizeof body);
    }
    return l;
}

static size_t plain_dataflash(const flight_log *l, double *const *columns)
{
    size_t rows = 0;
    for (const char *at = l->bytes + l->begin; at < l->bytes + l->size; at += 54) {
        uint64_t time;
        float value[6], temperature;
        if (at[2] != 20)
            continue;
        memcpy(&time, at + 3, 8);
        memcpy(value, at + 12, sizeof value);
        memcpy(&temperature, at + 44, 4);
        columns[0][rows] = (double)time * 1e-6;
        for (int i = 0; i < 6; i++)
            columns[1 + i][rows] = (double)value[i];
        columns[7][rows++] = (double)temperature;
    }
    return rows;
}

static void run_plain(void *context)
{
    flight_log *l = context;
    l->rows = l->plain(l, l->columns);
    bench_use(l->columns[0]);
}

static void run_imukit(void *context)
{
    flight_log *l = context;
    imk_log_settings settings = imk_log_default();
    settings.topic = l->topic;
    imk_log_reader *reader;
    size_t rows = 0;
    l->rows = 0;
    if (imk_log_open_memory(l->bytes, l->size, &settings, &reader, NULL) != IMK_OK)
        return;
    do {
        double *place[COLUMNS];
        for (int j = 0; j < COLUMNS; j++)
            place[j] = l->columns[j] + l->rows;
        if (imk_log_read(reader, BLOCK, place, &rows, NULL) != IMK_OK)
            rows = 0;
        l->rows += rows;
    } while (rows > 0);
    imk_log_close(reader);
}

static bool measure(const char *name, flight_log *l)
{
    double ours, plain;
    for (int j = 0; j < COLUMNS; j++) {
        l->columns[j] = calloc(ROWS + BLOCK, sizeof(double));
        if (!l->columns[j])
            exit(EXIT_FAILURE);
    }
    bench_compare(REPETITIONS, run_imukit, l, run_plain, l, &ours, &plain);
    run_imukit(l);
    const bool whole = l->rows == ROWS;
    bench_row_speed(name, ROWS / ours * 1e-6, ROWS / plain * 1e-6, "M rows/s", "-", 1);
    for (int j = 0; j < COLUMNS; j++)
        free(l->columns[j]);
    free(l->bytes);
    return whole;
}

int main(void)
{
    bench_pin();
    flight_log ulog = make_ulog(), dataflash = make_dataflash();
    ulog.plain = plain_ulog;
    dataflash.plain = plain_dataflash;
    puts("name,ours,yardstick,ratio,unit,isa,threads");
    const bool good = measure("flight_ulog_combined", &ulog);
    return measure("flight_dataflash_imu", &dataflash) && good ? EXIT_SUCCESS : EXIT_FAILURE;
}
