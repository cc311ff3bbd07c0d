/* SPDX-License-Identifier: Apache-2.0 */
/* Topics of one name, of which the messages are in two encodings: an MCAP file made here, after its
 * specification [MCAP]. */
#define _POSIX_C_SOURCE 200809L
#include "bag_files.h"

#include "io/log/ros/log_ros_imu_internal.h"

enum { ROWS = 40, ROOM = 1 << 16 };

typedef struct file {
    uint8_t bytes[ROOM];
    uint8_t *at;
    uint8_t *record; /* where its size is to be */
} file;

static void put_text(file *f, const char *text)
{
    f->at = imki_put_u32(f->at, (uint32_t)strlen(text));
    memcpy(f->at, text, strlen(text));
    f->at += strlen(text);
}

static void put_u16(file *f, uint16_t value)
{
    *f->at++ = (uint8_t)value;
    *f->at++ = (uint8_t)(value >> 8);
}

static void put_u64(file *f, uint64_t value)
{
    f->at = imki_put_u32(f->at, (uint32_t)value);
    f->at = imki_put_u32(f->at, (uint32_t)(value >> 32));
}

static void begin_record(file *f, uint8_t kind)
{
    *f->at++ = kind;
    f->record = f->at;
    f->at += 8;
}

static void end_record(file *f)
{
    uint8_t *end = f->at;
    f->at = f->record;
    put_u64(f, (uint64_t)(end - f->record - 8));
    f->at = end;
}

static void put_magic(file *f)
{
    memcpy(f->at, "\x89MCAP0\r\n", 8);
    f->at += 8;
}

/* Schema and channel of this number. */
static void put_channel(file *f, uint16_t number, const char *topic, bool cdr)
{
    begin_record(f, 3);
    put_u16(f, number);
    put_text(f, cdr ? "sensor_msgs/msg/Imu" : "sensor_msgs/Imu");
    put_text(f, cdr ? "ros2msg" : "ros1msg");
    put_text(f, cdr ? imki_ros2_imu_definition : imki_ros1_imu_definition);
    end_record(f);
    begin_record(f, 4);
    put_u16(f, number);
    put_u16(f, number);
    put_text(f, topic);
    put_text(f, cdr ? "cdr" : "ros1");
    f->at = imki_put_u32(f->at, 0);
    end_record(f);
}

static void put_message(file *f, uint16_t channel, bool cdr, int row, double rate)
{
    const imki_imu imu = {.stamp = INT64_C(1000000000) +
                                   row * INT64_C(10000000), /* 1 s and 10 ms a row */
                          .has = {true, true},
                          .value = {{rate, rate, rate}, {0, 0, 9.75}}};
    begin_record(f, 5);
    put_u16(f, channel);
    f->at = imki_put_u32(f->at, (uint32_t)row);
    put_u64(f, (uint64_t)imu.stamp);
    put_u64(f, (uint64_t)imu.stamp);
    f->at += imki_ros_imu_write(cdr ? IMKI_ROS_CDR : IMKI_ROS_1, &imu, (uint32_t)row, f->at);
    end_record(f);
}

/* /imu of ROS 1 with rates of 1, /imu of ROS 2 with 2, and /other with 3. @return the size */
static size_t make(file *f, bool other)
{
    f->at = f->bytes;
    put_magic(f);
    begin_record(f, 1);
    put_text(f, "");
    put_text(f, "");
    end_record(f);
    put_channel(f, 1, "/imu", false);
    put_channel(f, 2, "/imu", true);
    if (other)
        put_channel(f, 3, "/other", true);
    for (int i = 0; i < ROWS; i++) {
        put_message(f, 1, false, i, 1);
        put_message(f, 2, true, i, 2);
        if (other)
            put_message(f, 3, true, i, 3);
    }
    begin_record(f, 15);
    f->at = imki_put_u32(f->at, 0);
    end_record(f);
    begin_record(f, 2);
    put_u64(f, 0);
    put_u64(f, 0);
    f->at = imki_put_u32(f->at, 0);
    end_record(f);
    put_magic(f);
    return (size_t)(f->at - f->bytes);
}

/* @param rate  of the sensor that is due; 0: it is refused with this */
static void check_choice(const file *f, size_t size, const char *topic, int instance, double rate,
                         const char *expected)
{
    static bag_table t;
    imk_log_settings settings = imk_log_default();
    imk_log_reader *reader = NULL;
    imk_error error;
    settings.topic = topic;
    settings.instance = instance + 1;
    const imk_status status =
        imk_log_open_memory((const char *)f->bytes, size, &settings, &reader, &error);
    if (rate == 0) {
        CHECK_STATUS(status, IMK_ERROR_NAME_UNKNOWN);
        assert_string_equal(error.expected, expected);
        return;
    }
    CHECK_OK(status);
    CHECK_OK(bag_read(reader, 100, &t, &error));
    assert_int_equal(t.rows, ROWS);
    for (int i = 0; i < ROWS; i++)
        assert_true(t.data[1][i] == rate);
    imk_log_close(reader);
}

static void test_one_name(void **state)
{
    (void)state;
    static file f;
    size_t size = make(&f, false);
    check_choice(&f, size, NULL, -1, 0,
                 "add --topic /imu --instance 0 (or --topic /imu --instance 1)");
    check_choice(&f, size, "/imu", -1, 0, "add --instance 0 (or --instance 1)");
    check_choice(&f, size, "/imu", 0, 1, NULL);
    check_choice(&f, size, "/imu", 1, 2, NULL);
    check_choice(&f, size, NULL, 1, 2, NULL);
    check_choice(&f, size, "/imu", 2, 0, "add --instance 0 (or --instance 1)");
    size = make(&f, true);
    check_choice(&f, size, "/other", -1, 3, NULL);
    check_choice(&f, size, "/imu", 1, 2, NULL);
    /* The only one of its name is the first. */
    check_choice(&f, size, "/other", 0, 3, NULL);
    check_choice(&f, size, NULL, 0, 0, "add --topic /imu --instance 0 (or --topic /other)");
}

/* Sensors that are told apart by names have no numbers but the first. */
static void test_no_instance(void **state)
{
    (void)state;
    imk_log_settings settings = imk_log_default();
    settings.instance = 1 + 1;
    bag_refused(BAGS "none.bag", &settings, IMK_ERROR_NAME_UNKNOWN, "told apart by their names",
                "leave --instance out");
    static bag_table t;
    imk_error error;
    settings.instance = 1;
    CHECK_OK(bag_load(BAGS "none.bag", &settings, &t, &error));
    assert_int_equal(t.rows, 10);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_one_name),
        cmocka_unit_test(test_no_instance),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
