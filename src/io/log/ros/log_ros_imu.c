/* SPDX-License-Identifier: Apache-2.0 */
/* sensor_msgs/Imu. Its fields, in this order [ROSMSGS]:
 *
 *     header: (sequence, only in ROS 1) stamp: seconds, nanoseconds; frame_id: text
 *     orientation: x y z w                  orientation_covariance: 9
 *     angular_velocity: x y z [rad/s]       angular_velocity_covariance: 9
 *     linear_acceleration: x y z [m/s^2]    linear_acceleration_covariance: 9
 *
 * ROS 1 [ROSSER]: little-endian, without padding; a text is its length and its bytes.
 * ROS 2 [CDR]: two bytes of representation and two of options; then numbers of n bytes at multiples
 * of n from there; a text ends with a zero, which counts.
 *
 * linear_acceleration is the specific force: at rest, and level, it shows the reaction to gravity
 * [REP145]. A first covariance of -1 says that the sensor does not give the quantity. */
#include "log_ros_imu_internal.h"

#include <math.h>

enum {
    ORIENTATION_W = 3, /* doubles behind the text */
    ORIENTATION_COVARIANCE = 4,
    RATE = 13,
    RATE_COVARIANCE = 16,
    FORCE = 25,
    FORCE_COVARIANCE = 28,
    DOUBLES = 37,
    BILLION = 1000000000,
    CDR_BIG = 0,
    CDR_LITTLE = 1,
    CDR_HEAD = 4
};

/* ROS 1 lists the definitions of the types within behind lines of 80 "=". */
#define RULE "================================================================================\n"
#define FIELDS                                                                                     \
    "geometry_msgs/Quaternion orientation\n"                                                       \
    "float64[9] orientation_covariance\n"                                                          \
    "geometry_msgs/Vector3 angular_velocity\n"                                                     \
    "float64[9] angular_velocity_covariance\n"                                                     \
    "geometry_msgs/Vector3 linear_acceleration\n"                                                  \
    "float64[9] linear_acceleration_covariance\n"
#define WITHIN                                                                                     \
    RULE "MSG: geometry_msgs/Quaternion\n"                                                         \
         "float64 x\nfloat64 y\nfloat64 z\nfloat64 w\n" RULE "MSG: geometry_msgs/Vector3\n"        \
         "float64 x\nfloat64 y\nfloat64 z\n"

const char imki_ros1_imu_definition[] = "Header header\n" FIELDS RULE "MSG: std_msgs/Header\n"
                                        "uint32 seq\ntime stamp\nstring frame_id\n" WITHIN;
const char imki_ros2_imu_definition[] =
    "std_msgs/Header header\n" FIELDS RULE "MSG: std_msgs/Header\n"
    "builtin_interfaces/Time stamp\nstring frame_id\n" RULE "MSG: builtin_interfaces/Time\n"
    "int32 sec\nuint32 nanosec\n" WITHIN;
const char imki_ros1_imu_digest[] = "6a62c6daae103f4ff57a132d6f95cec2";

static double turned_f64(const uint8_t *at)
{
    uint8_t turned[8];
    for (int i = 0; i < 8; i++)
        turned[i] = at[7 - i];
    return imki_get_f64(turned);
}

static uint32_t turned_u32(const uint8_t *at)
{
    return (uint32_t)at[0] << 24 | (uint32_t)at[1] << 16 | (uint32_t)at[2] << 8 | at[3];
}

/* @param at  the first of the doubles */
static void read_values(const uint8_t *at, bool big, imki_imu *imu)
{
    static const int first[2] = {RATE, FORCE}, covariance[2] = {RATE_COVARIANCE, FORCE_COVARIANCE};
    double (*const get)(const uint8_t *) = big ? turned_f64 : imki_get_f64;
    for (int k = 0; k < 2; k++) {
        imu->has[k] = get(at + (size_t)(8 * covariance[k])) != -1.0;
        for (int i = 0; i < 3; i++)
            imu->value[k][i] = imu->has[k] ? get(at + (size_t)(8 * (first[k] + i))) : (double)NAN;
    }
}

static bool fits_ros1(const uint8_t *data, size_t size)
{
    enum { FIXED = 16 + 8 * DOUBLES };
    return size >= FIXED && imki_get_u32(data + 12) == size - FIXED;
}

static bool read_ros1(const uint8_t *data, size_t size, imki_imu *imu)
{
    if (!fits_ros1(data, size))
        return false;
    imu->stamp = (int64_t)imki_get_u32(data + 4) * BILLION + imki_get_u32(data + 8);
    imu->frame = data + 16;
    imu->frame_size = imki_get_u32(data + 12);
    read_values(data + size - 8 * DOUBLES, false, imu);
    return true;
}

/* Bytes from the beginning to the doubles; 0: it is no Imu. */
static size_t cdr_doubles(const uint8_t *data, size_t size)
{
    if (size < CDR_HEAD + 12 || data[0] != 0 || data[1] > CDR_LITTLE)
        return 0;
    const size_t left = size - CDR_HEAD - 12;
    const size_t text = (data[1] == CDR_BIG ? turned_u32 : imki_get_u32)(data + CDR_HEAD + 8);
    if (text > left)
        return 0;
    const size_t begin = CDR_HEAD + ((12 + text + 7) & ~(size_t)7);
    return size < begin || size - begin < 8 * DOUBLES ? 0 : begin;
}

static bool read_cdr(const uint8_t *data, size_t size, imki_imu *imu)
{
    const size_t begin = cdr_doubles(data, size);
    if (begin == 0)
        return false;
    const bool big = data[1] == CDR_BIG;
    uint32_t (*const get)(const uint8_t *) = big ? turned_u32 : imki_get_u32;
    /* The seconds have a sign. */
    imu->stamp = (int64_t)(int32_t)get(data + CDR_HEAD) * BILLION + get(data + CDR_HEAD + 4);
    const size_t text = get(data + CDR_HEAD + 8);
    imu->frame = data + CDR_HEAD + 12;
    imu->frame_size = text > 0 ? text - 1 : 0;
    read_values(data + begin, big, imu);
    return true;
}

int imki_ros_imu_representation(const uint8_t *data, size_t size)
{
    enum { LARGEST = 0x1F }; /* of those that are given away */
    return size >= CDR_HEAD && data[0] == 0 && data[1] > CDR_LITTLE && data[1] <= LARGEST ? data[1]
                                                                                          : 0;
}

bool imki_ros_imu_fits(imki_ros_encoding encoding, const uint8_t *data, size_t size)
{
    if (encoding == IMKI_ROS_1)
        return fits_ros1(data, size);
    const size_t begin = encoding == IMKI_ROS_CDR ? cdr_doubles(data, size) : 0;
    return begin > 0 && size - begin == 8 * DOUBLES;
}

bool imki_ros_imu_read(imki_ros_encoding encoding, const uint8_t *data, size_t size, imki_imu *imu)
{
    return encoding == IMKI_ROS_1     ? read_ros1(data, size, imu)
           : encoding == IMKI_ROS_CDR ? read_cdr(data, size, imu)
                                      : false;
}

size_t imki_ros_imu_write(imki_ros_encoding encoding, const imki_imu *imu, uint32_t sequence,
                          uint8_t data[IMKI_ROS_IMU_MAX])
{
    static const int first[2] = {RATE, FORCE}, covariance[2] = {RATE_COVARIANCE, FORCE_COVARIANCE};
    const bool cdr = encoding == IMKI_ROS_CDR;
    /* Seconds rounded down, so that nanoseconds are not negative. */
    int64_t seconds = imu->stamp / BILLION, rest = imu->stamp % BILLION;
    if (rest < 0) {
        rest += BILLION;
        seconds--;
    }
    uint8_t *at = data;
    memset(data, 0, IMKI_ROS_IMU_MAX);
    if (cdr)
        at[1] = CDR_LITTLE;
    at = cdr ? at + CDR_HEAD : imki_put_u32(at, sequence);
    at = imki_put_u32(at, (uint32_t)seconds);
    at = imki_put_u32(at, (uint32_t)rest);
    /* "imu" and, in CDR, its zero: the doubles follow at once, 16 bytes behind the head. */
    at = imki_put_u32(at, cdr ? 4 : 3);
    memcpy(at, "imu", 3);
    at += cdr ? 4 : 3;
    imki_put_f64(at + 8 * ORIENTATION_W, 1.0);           /* no turn */
    imki_put_f64(at + 8 * ORIENTATION_COVARIANCE, -1.0); /* the orientation is not known */
    for (int k = 0; k < 2; k++) {
        if (!imu->has[k])
            imki_put_f64(at + (size_t)(8 * covariance[k]), -1.0);
        for (int i = 0; i < 3 && imu->has[k]; i++)
            imki_put_f64(at + (size_t)(8 * (first[k] + i)), imu->value[k][i]);
    }
    return (size_t)(at - data) + 8 * DOUBLES;
}
