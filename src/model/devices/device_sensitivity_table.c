/* SPDX-License-Identifier: Apache-2.0 */
/* Sensitivities by range, as the sources print them; docs/devices.md says what was read. 16-bit
 * values of Analog Devices are 2^-16 of the 32-bit ones, which the drivers state. */
#include "device_sensitivity_internal.h"

#define GYRO IMK_COUNTS_GYRO
#define ACCEL IMK_COUNTS_ACCEL
#define TEMPERATURE IMK_COUNTS_TEMPERATURE

#define BMI088 "data sheet BST-BMI088-DS000-19 (rev. 1.9), tables 4 and 5"
#define BMI088_REGISTERS "data sheet BST-BMI088-DS001-13 (rev. 1.3), 5.3.7"
#define BMI160 "data sheet BMI160 rev. 1.0 (2020-11), output signals, as copied in a report"
#define BMI160_DRIVER "public driver of the BMI160: 0.001953125 K per count, 23 degC at 0"
#define BMI270 "docs.luxonis.com: BMI270, native silicon characteristics"
#define BMI270_DRIVER "public driver of the BMI270: count/512 + 23 degC"
#define ICM20948 "data sheet DS-000189 rev. 1.3, page 14, as copied in a report"
#define ICM20948_DRIVER "PX4-Autopilot: ICM20948.cpp; the data sheet rounds to 131 LSB at 250 deg/s"
#define ICM42688P "data sheet of the ICM-42688-P, tables 1 and 2, section 3.3.2"
#define MPU6050_DRIVER "public drivers of the MPU-6050, which agree"
#define MPU9250_DRIVER "PX4-Autopilot: MPU9250.cpp"
#define MPU9250_TEMPERATURE "data sheet MPU-9250, formula of the temperature, as copied in a driver"
#define LSM6DSO "data sheet DS12140 rev. 3, table 2, as copied in FlySight's sensornoise.cpp"
#define LSM6DSO_DRIVER "data sheet DS12140 rev. 3, as copied in the driver of imud"
#define ISM330DHCX "data sheet DS13012 rev. 6, as copied in notes of a laboratory course"
#define ISM330DHCX_DRIVER "ST's driver ism330dhcx_reg.c"
#define ADIS16470 "Linux: drivers/iio/imu/adis16475.c; ranges from data sheet rev. C as copied"
#define ADIS16475 "Linux: drivers/iio/imu/adis16475.c"
#define ADIS16480 "Linux: drivers/iio/imu/adis16480.c"
#define ADIS16505                                                                                  \
    "Linux: drivers/iio/imu/adis16475.c; accelerometers: ADI's driver of the ADIS1650x"

const imki_sensitivity_row imki_sensitivity_rows[] = {
    /* Bosch */
    {"BMI088", GYRO, 16, "125 deg/s", "262.144 LSB/(deg/s)", BMI088, 0},
    {"BMI088", GYRO, 16, "250 deg/s", "131.072 LSB/(deg/s)", BMI088, 0},
    {"BMI088", GYRO, 16, "500 deg/s", "65.536 LSB/(deg/s)", BMI088, 0},
    {"BMI088", GYRO, 16, "1000 deg/s", "32.768 LSB/(deg/s)", BMI088, 0},
    {"BMI088", GYRO, 16, "2000 deg/s", "16.384 LSB/(deg/s)", BMI088, 0},
    {"BMI088", ACCEL, 16, "3 g", "10920 LSB/g", BMI088, 0},
    {"BMI088", ACCEL, 16, "6 g", "5460 LSB/g", BMI088, 0},
    {"BMI088", ACCEL, 16, "12 g", "2730 LSB/g", BMI088, 0},
    {"BMI088", ACCEL, 16, "24 g", "1365 LSB/g", BMI088, 0},
    {"BMI088", TEMPERATURE, 11, "", "0.125 K/LSB", BMI088_REGISTERS, 23},
    {"BMI160", GYRO, 16, "125 deg/s", "262.4 LSB/(deg/s)", BMI160, 0},
    {"BMI160", GYRO, 16, "250 deg/s", "131.2 LSB/(deg/s)", BMI160, 0},
    {"BMI160", GYRO, 16, "500 deg/s", "65.6 LSB/(deg/s)", BMI160, 0},
    {"BMI160", GYRO, 16, "1000 deg/s", "32.8 LSB/(deg/s)", BMI160, 0},
    {"BMI160", GYRO, 16, "2000 deg/s", "16.4 LSB/(deg/s)", BMI160, 0},
    {"BMI160", ACCEL, 16, "2 g", "16384 LSB/g", BMI160, 0},
    {"BMI160", ACCEL, 16, "4 g", "8192 LSB/g", BMI160, 0},
    {"BMI160", ACCEL, 16, "8 g", "4096 LSB/g", BMI160, 0},
    {"BMI160", ACCEL, 16, "16 g", "2048 LSB/g", BMI160, 0},
    {"BMI160", TEMPERATURE, 16, "", "512 LSB/K", BMI160_DRIVER, 23},
    {"BMI270", GYRO, 16, "125 deg/s", "262.144 LSB/(deg/s)", BMI270, 0},
    {"BMI270", GYRO, 16, "250 deg/s", "131.072 LSB/(deg/s)", BMI270, 0},
    {"BMI270", GYRO, 16, "500 deg/s", "65.536 LSB/(deg/s)", BMI270, 0},
    {"BMI270", GYRO, 16, "1000 deg/s", "32.768 LSB/(deg/s)", BMI270, 0},
    {"BMI270", GYRO, 16, "2000 deg/s", "16.384 LSB/(deg/s)", BMI270, 0},
    {"BMI270", ACCEL, 16, "2 g", "16384 LSB/g", BMI270, 0},
    {"BMI270", ACCEL, 16, "4 g", "8192 LSB/g", BMI270, 0},
    {"BMI270", ACCEL, 16, "8 g", "4096 LSB/g", BMI270, 0},
    {"BMI270", ACCEL, 16, "16 g", "2048 LSB/g", BMI270, 0},
    {"BMI270", TEMPERATURE, 16, "", "512 LSB/K", BMI270_DRIVER, 23},
    /* TDK InvenSense */
    {"ICM-20948", GYRO, 16, "250 deg/s", "131.072 LSB/(deg/s)", ICM20948_DRIVER, 0},
    {"ICM-20948", GYRO, 16, "500 deg/s", "65.536 LSB/(deg/s)", ICM20948_DRIVER, 0},
    {"ICM-20948", GYRO, 16, "1000 deg/s", "32.768 LSB/(deg/s)", ICM20948_DRIVER, 0},
    {"ICM-20948", GYRO, 16, "2000 deg/s", "16.384 LSB/(deg/s)", ICM20948_DRIVER, 0},
    {"ICM-20948", ACCEL, 16, "2 g", "16384 LSB/g", ICM20948_DRIVER, 0},
    {"ICM-20948", ACCEL, 16, "4 g", "8192 LSB/g", ICM20948_DRIVER, 0},
    {"ICM-20948", ACCEL, 16, "8 g", "4096 LSB/g", ICM20948_DRIVER, 0},
    {"ICM-20948", ACCEL, 16, "16 g", "2048 LSB/g", ICM20948_DRIVER, 0},
    {"ICM-20948", TEMPERATURE, 16, "", "333.87 LSB/degC", ICM20948, 21},
    {"ICM-42688-P", GYRO, 16, "15.625 deg/s", "2097.2 LSB/(deg/s)", ICM42688P, 0},
    {"ICM-42688-P", GYRO, 16, "31.25 deg/s", "1048.6 LSB/(deg/s)", ICM42688P, 0},
    {"ICM-42688-P", GYRO, 16, "62.5 deg/s", "524.3 LSB/(deg/s)", ICM42688P, 0},
    {"ICM-42688-P", GYRO, 16, "125 deg/s", "262 LSB/(deg/s)", ICM42688P, 0},
    {"ICM-42688-P", GYRO, 16, "250 deg/s", "131 LSB/(deg/s)", ICM42688P, 0},
    {"ICM-42688-P", GYRO, 16, "500 deg/s", "65.5 LSB/(deg/s)", ICM42688P, 0},
    {"ICM-42688-P", GYRO, 16, "1000 deg/s", "32.8 LSB/(deg/s)", ICM42688P, 0},
    {"ICM-42688-P", GYRO, 16, "2000 deg/s", "16.4 LSB/(deg/s)", ICM42688P, 0},
    {"ICM-42688-P", ACCEL, 16, "2 g", "16384 LSB/g", ICM42688P, 0},
    {"ICM-42688-P", ACCEL, 16, "4 g", "8192 LSB/g", ICM42688P, 0},
    {"ICM-42688-P", ACCEL, 16, "8 g", "4096 LSB/g", ICM42688P, 0},
    {"ICM-42688-P", ACCEL, 16, "16 g", "2048 LSB/g", ICM42688P, 0},
    {"ICM-42688-P", TEMPERATURE, 16, "", "132.48 LSB/degC", ICM42688P, 25},
    {"MPU-6050", GYRO, 16, "250 deg/s", "131 LSB/(deg/s)", MPU6050_DRIVER, 0},
    {"MPU-6050", GYRO, 16, "500 deg/s", "65.5 LSB/(deg/s)", MPU6050_DRIVER, 0},
    {"MPU-6050", GYRO, 16, "1000 deg/s", "32.8 LSB/(deg/s)", MPU6050_DRIVER, 0},
    {"MPU-6050", GYRO, 16, "2000 deg/s", "16.4 LSB/(deg/s)", MPU6050_DRIVER, 0},
    {"MPU-6050", ACCEL, 16, "2 g", "16384 LSB/g", MPU6050_DRIVER, 0},
    {"MPU-6050", ACCEL, 16, "4 g", "8192 LSB/g", MPU6050_DRIVER, 0},
    {"MPU-6050", ACCEL, 16, "8 g", "4096 LSB/g", MPU6050_DRIVER, 0},
    {"MPU-6050", ACCEL, 16, "16 g", "2048 LSB/g", MPU6050_DRIVER, 0},
    {"MPU-6050", TEMPERATURE, 16, "", "340 LSB/degC", MPU6050_DRIVER, 36.53},
    {"MPU-9250", GYRO, 16, "250 deg/s", "131.072 LSB/(deg/s)", MPU9250_DRIVER, 0},
    {"MPU-9250", GYRO, 16, "500 deg/s", "65.536 LSB/(deg/s)", MPU9250_DRIVER, 0},
    {"MPU-9250", GYRO, 16, "1000 deg/s", "32.768 LSB/(deg/s)", MPU9250_DRIVER, 0},
    {"MPU-9250", GYRO, 16, "2000 deg/s", "16.384 LSB/(deg/s)", MPU9250_DRIVER, 0},
    {"MPU-9250", ACCEL, 16, "2 g", "16384 LSB/g", MPU9250_DRIVER, 0},
    {"MPU-9250", ACCEL, 16, "4 g", "8192 LSB/g", MPU9250_DRIVER, 0},
    {"MPU-9250", ACCEL, 16, "8 g", "4096 LSB/g", MPU9250_DRIVER, 0},
    {"MPU-9250", ACCEL, 16, "16 g", "2048 LSB/g", MPU9250_DRIVER, 0},
    {"MPU-9250", TEMPERATURE, 16, "", "333.87 LSB/degC", MPU9250_TEMPERATURE, 21},
    /* STMicroelectronics */
    {"LSM6DSO", GYRO, 16, "125 deg/s", "4.375 mdps/LSB", LSM6DSO, 0},
    {"LSM6DSO", GYRO, 16, "250 deg/s", "8.75 mdps/LSB", LSM6DSO, 0},
    {"LSM6DSO", GYRO, 16, "500 deg/s", "17.5 mdps/LSB", LSM6DSO, 0},
    {"LSM6DSO", GYRO, 16, "1000 deg/s", "35 mdps/LSB", LSM6DSO, 0},
    {"LSM6DSO", GYRO, 16, "2000 deg/s", "70 mdps/LSB", LSM6DSO, 0},
    {"LSM6DSO", ACCEL, 16, "2 g", "0.061 mg/LSB", LSM6DSO, 0},
    {"LSM6DSO", ACCEL, 16, "4 g", "0.122 mg/LSB", LSM6DSO, 0},
    {"LSM6DSO", ACCEL, 16, "8 g", "0.244 mg/LSB", LSM6DSO, 0},
    {"LSM6DSO", ACCEL, 16, "16 g", "0.488 mg/LSB", LSM6DSO, 0},
    {"LSM6DSO", TEMPERATURE, 16, "", "256 LSB/degC", LSM6DSO_DRIVER, 25},
    {"ISM330DHCX", GYRO, 16, "125 deg/s", "4.375 mdps/LSB", ISM330DHCX, 0},
    {"ISM330DHCX", GYRO, 16, "250 deg/s", "8.75 mdps/LSB", ISM330DHCX, 0},
    {"ISM330DHCX", GYRO, 16, "500 deg/s", "17.5 mdps/LSB", ISM330DHCX, 0},
    {"ISM330DHCX", GYRO, 16, "1000 deg/s", "35 mdps/LSB", ISM330DHCX, 0},
    {"ISM330DHCX", GYRO, 16, "2000 deg/s", "70 mdps/LSB", ISM330DHCX, 0},
    {"ISM330DHCX", GYRO, 16, "4000 deg/s", "140 mdps/LSB", ISM330DHCX, 0},
    {"ISM330DHCX", ACCEL, 16, "2 g", "0.061 mg/LSB", ISM330DHCX, 0},
    {"ISM330DHCX", ACCEL, 16, "4 g", "0.122 mg/LSB", ISM330DHCX, 0},
    {"ISM330DHCX", ACCEL, 16, "8 g", "0.244 mg/LSB", ISM330DHCX, 0},
    {"ISM330DHCX", ACCEL, 16, "16 g", "0.488 mg/LSB", ISM330DHCX, 0},
    {"ISM330DHCX", TEMPERATURE, 16, "", "256 LSB/degC", ISM330DHCX_DRIVER, 25},
    /* Analog Devices: registers of 16 bits, and words of 32 bits with the lower registers */
    {"ADIS16465-1", GYRO, 16, "", "160 LSB/(deg/s)", ADIS16475, 0},
    {"ADIS16465-1", GYRO, 32, "", "10485760 LSB/(deg/s)", ADIS16475, 0},
    {"ADIS16465-1", ACCEL, 16, "", "4000 LSB/g", ADIS16475, 0},
    {"ADIS16465-1", ACCEL, 32, "", "262144000 LSB/g", ADIS16475, 0},
    {"ADIS16465-1", TEMPERATURE, 16, "", "0.1 K/LSB", ADIS16475, 0},
    {"ADIS16465-2", GYRO, 16, "", "40 LSB/(deg/s)", ADIS16475, 0},
    {"ADIS16465-2", GYRO, 32, "", "2621440 LSB/(deg/s)", ADIS16475, 0},
    {"ADIS16465-2", ACCEL, 16, "", "4000 LSB/g", ADIS16475, 0},
    {"ADIS16465-2", ACCEL, 32, "", "262144000 LSB/g", ADIS16475, 0},
    {"ADIS16465-2", TEMPERATURE, 16, "", "0.1 K/LSB", ADIS16475, 0},
    {"ADIS16465-3", GYRO, 16, "", "10 LSB/(deg/s)", ADIS16475, 0},
    {"ADIS16465-3", GYRO, 32, "", "655360 LSB/(deg/s)", ADIS16475, 0},
    {"ADIS16465-3", ACCEL, 16, "", "4000 LSB/g", ADIS16475, 0},
    {"ADIS16465-3", ACCEL, 32, "", "262144000 LSB/g", ADIS16475, 0},
    {"ADIS16465-3", TEMPERATURE, 16, "", "0.1 K/LSB", ADIS16475, 0},
    {"ADIS16470", GYRO, 16, "2000 deg/s", "10 LSB/(deg/s)", ADIS16470, 0},
    {"ADIS16470", GYRO, 32, "2000 deg/s", "655360 LSB/(deg/s)", ADIS16470, 0},
    {"ADIS16470", ACCEL, 16, "40 g", "800 LSB/g", ADIS16470, 0},
    {"ADIS16470", ACCEL, 32, "40 g", "52428800 LSB/g", ADIS16470, 0},
    {"ADIS16470", TEMPERATURE, 16, "", "0.1 K/LSB", ADIS16470, 0},
    {"ADIS16475-1", GYRO, 16, "", "160 LSB/(deg/s)", ADIS16475, 0},
    {"ADIS16475-1", GYRO, 32, "", "10485760 LSB/(deg/s)", ADIS16475, 0},
    {"ADIS16475-1", ACCEL, 16, "", "4000 LSB/g", ADIS16475, 0},
    {"ADIS16475-1", ACCEL, 32, "", "262144000 LSB/g", ADIS16475, 0},
    {"ADIS16475-1", TEMPERATURE, 16, "", "0.1 K/LSB", ADIS16475, 0},
    {"ADIS16475-2", GYRO, 16, "", "40 LSB/(deg/s)", ADIS16475, 0},
    {"ADIS16475-2", GYRO, 32, "", "2621440 LSB/(deg/s)", ADIS16475, 0},
    {"ADIS16475-2", ACCEL, 16, "", "4000 LSB/g", ADIS16475, 0},
    {"ADIS16475-2", ACCEL, 32, "", "262144000 LSB/g", ADIS16475, 0},
    {"ADIS16475-2", TEMPERATURE, 16, "", "0.1 K/LSB", ADIS16475, 0},
    {"ADIS16475-3", GYRO, 16, "", "10 LSB/(deg/s)", ADIS16475, 0},
    {"ADIS16475-3", GYRO, 32, "", "655360 LSB/(deg/s)", ADIS16475, 0},
    {"ADIS16475-3", ACCEL, 16, "", "4000 LSB/g", ADIS16475, 0},
    {"ADIS16475-3", ACCEL, 32, "", "262144000 LSB/g", ADIS16475, 0},
    {"ADIS16475-3", TEMPERATURE, 16, "", "0.1 K/LSB", ADIS16475, 0},
    {"ADIS16488", GYRO, 16, "450 deg/s", "50 LSB/(deg/s)", ADIS16480, 0},
    {"ADIS16488", GYRO, 32, "450 deg/s", "3276800 LSB/(deg/s)", ADIS16480, 0},
    {"ADIS16488", ACCEL, 16, "18 g", "1250 LSB/g", ADIS16480, 0},
    {"ADIS16488", ACCEL, 32, "18 g", "81920000 LSB/g", ADIS16480, 0},
    {"ADIS16488", TEMPERATURE, 16, "", "0.00565 K/LSB", ADIS16480, 25},
    {"ADIS16495-1", GYRO, 16, "125 deg/s", "160 LSB/(deg/s)", ADIS16480, 0},
    {"ADIS16495-1", GYRO, 32, "125 deg/s", "10485760 LSB/(deg/s)", ADIS16480, 0},
    {"ADIS16495-1", ACCEL, 16, "8 g", "4000 LSB/g", ADIS16480, 0},
    {"ADIS16495-1", ACCEL, 32, "8 g", "262144000 LSB/g", ADIS16480, 0},
    {"ADIS16495-1", TEMPERATURE, 16, "", "0.0125 K/LSB", ADIS16480, 25},
    {"ADIS16495-2", GYRO, 16, "450 deg/s", "40 LSB/(deg/s)", ADIS16480, 0},
    {"ADIS16495-2", GYRO, 32, "450 deg/s", "2621440 LSB/(deg/s)", ADIS16480, 0},
    {"ADIS16495-2", ACCEL, 16, "8 g", "4000 LSB/g", ADIS16480, 0},
    {"ADIS16495-2", ACCEL, 32, "8 g", "262144000 LSB/g", ADIS16480, 0},
    {"ADIS16495-2", TEMPERATURE, 16, "", "0.0125 K/LSB", ADIS16480, 25},
    {"ADIS16495-3", GYRO, 16, "2000 deg/s", "10 LSB/(deg/s)", ADIS16480, 0},
    {"ADIS16495-3", GYRO, 32, "2000 deg/s", "655360 LSB/(deg/s)", ADIS16480, 0},
    {"ADIS16495-3", ACCEL, 16, "8 g", "4000 LSB/g", ADIS16480, 0},
    {"ADIS16495-3", ACCEL, 32, "8 g", "262144000 LSB/g", ADIS16480, 0},
    {"ADIS16495-3", TEMPERATURE, 16, "", "0.0125 K/LSB", ADIS16480, 25},
    {"ADIS16505-1", GYRO, 16, "", "160 LSB/(deg/s)", ADIS16505, 0},
    {"ADIS16505-1", GYRO, 32, "", "10485760 LSB/(deg/s)", ADIS16505, 0},
    {"ADIS16505-1", ACCEL, 16, "", "408.268 LSB/(m/s^2)", ADIS16505, 0},
    {"ADIS16505-1", ACCEL, 32, "", "26756268 LSB/(m/s^2)", ADIS16505, 0},
    {"ADIS16505-1", TEMPERATURE, 16, "", "0.1 K/LSB", ADIS16505, 0},
    {"ADIS16505-2", GYRO, 16, "", "40 LSB/(deg/s)", ADIS16505, 0},
    {"ADIS16505-2", GYRO, 32, "", "2621440 LSB/(deg/s)", ADIS16505, 0},
    {"ADIS16505-2", ACCEL, 16, "", "408.268 LSB/(m/s^2)", ADIS16505, 0},
    {"ADIS16505-2", ACCEL, 32, "", "26756268 LSB/(m/s^2)", ADIS16505, 0},
    {"ADIS16505-2", TEMPERATURE, 16, "", "0.1 K/LSB", ADIS16505, 0},
    {"ADIS16505-3", GYRO, 16, "", "10 LSB/(deg/s)", ADIS16505, 0},
    {"ADIS16505-3", GYRO, 32, "", "655360 LSB/(deg/s)", ADIS16505, 0},
    {"ADIS16505-3", ACCEL, 16, "", "408.268 LSB/(m/s^2)", ADIS16505, 0},
    {"ADIS16505-3", ACCEL, 32, "", "26756268 LSB/(m/s^2)", ADIS16505, 0},
    {"ADIS16505-3", TEMPERATURE, 16, "", "0.1 K/LSB", ADIS16505, 0},
};
const size_t imki_sensitivity_row_count =
    sizeof imki_sensitivity_rows / sizeof imki_sensitivity_rows[0];

const imki_sensitivity_alias imki_sensitivity_aliases[] = {
    {"MPU-6000", "MPU-6050"}, /* one data sheet for both, PS-MPU-6000A-00 */
};
const size_t imki_sensitivity_alias_count =
    sizeof imki_sensitivity_aliases / sizeof imki_sensitivity_aliases[0];
