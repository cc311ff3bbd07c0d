/* SPDX-License-Identifier: Apache-2.0 */
/* imk_atan2() against multiprecision angles (tests/reference/arc_tangent.py) and, on many points,
 * the C library's long double one. */
#include "check.h"

#include "imukit/elementary.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* y, x, and their angle as a double and the rest */
static const double reference[][4] = {
    {0x1.0000000000000p+0, 0x1.0000000000000p+0, 0x1.921fb54442d18p-1, 0x1.1a62633145c07p-55},
    {0x1.0000000000000p+0, -0x1.0000000000000p+0, 0x1.2d97c7f3321d2p+1, 0x1.a79394c9e8a0ap-54},
    {-0x1.0000000000000p+0, -0x1.8000000000000p+1, -0x1.68f095fdf593cp+1, -0x1.10419152a6383p-54},
    {0x1.0000000000000p-5, 0x1.0000000000000p+0, 0x1.ffd55bba97625p-6, -0x1.5ec431444912cp-60},
    {0x1.0000000000000p+0, 0x1.0000000000000p-5, 0x1.8a205fd558740p+0, -0x1.30228c09a91b4p-54},
    {0x0.0000000000001p-1022, 0x0.0000000000002p-1022, 0x1.dac670561bb4fp-2, 0x1.a2b7f222f65e2p-56},
    {0x1.e42d130773b76p+1023, 0x1.c7b1f3cac7433p+1023, 0x1.a1a25f2c82506p-1,
     -0x1.904f54e11fda7p-56},
    {0x1.56e1fc2f8f359p-997, 0x1.8f2b061aea072p-964, 0x1.b7cdfd9d7bdbap-34, 0x1.822dddc080eb4p-88},
    {0x1.0000000000000p-28, 0x1.0000000000000p+0, 0x1.0000000000000p-28, -0x1.5555555555555p-86},
    {0x1.0000000000000p-29, 0x1.0000000000000p+0, 0x1.0000000000000p-29, -0x1.5555555555555p-89},
    {-0x1.0000000000000p-163, 0x1.94c06944e94cep-162, -0x1.39a47c78def04p-2,
     -0x1.62f3b083cb4abp-56},
    {0x1.0000000000000p-180, 0x1.da8ef8f159393p-181, 0x1.a58bb82c8e758p-1, 0x1.e08086cb1e8b3p-56},
    {-0x1.0000000000000p+88, 0x1.e788d34dfc12ep+94, -0x1.0cd7315cd5dadp-7, 0x1.536480f056c15p-61},
    {0x1.0000000000000p-271, 0x1.5b32548fc8077p-262, 0x1.7983d3ff51a22p-10, -0x1.03dc4b6ca8ebbp-64},
    {0x1.0000000000000p-298, -0x1.9fdeb843388d6p-294, 0x1.8d33a0bd9c03dp+1, 0x1.58d9e1a96e049p-56},
    {-0x1.0000000000000p-196, -0x1.8d59114b7a994p-187, -0x1.91f6798687b27p+1,
     -0x1.ac3dc88870b8fp-54},
    {-0x1.0000000000000p-274, 0x1.811ad36e857f2p-271, -0x1.5392f1d6fb0ccp-4,
     -0x1.5499994f471c4p-58},
    {-0x1.0000000000000p-79, -0x1.31e99e95b0146p-68, -0x1.921251918f27bp+1, 0x1.ad443672f9e9ep-53},
    {-0x1.0000000000000p+148, 0x1.743819f014c09p+158, -0x1.6022f77c3e0edp-11,
     0x1.6cf8d07ae8fb3p-65},
    {0x1.0000000000000p-64, 0x1.2f400f7236556p-60, 0x1.afd2d098e714bp-5, -0x1.8ccb3c696efdbp-60},
    {-0x1.0000000000000p-278, -0x1.fbdeff8d362f1p-281, -0x1.d05a37bcc8e73p+0,
     -0x1.338aa7f0521f6p-54},
    {0x1.0000000000000p+3, 0x1.de29c1e32628fp-7, 0x1.91a82adc7a4b5p+0, 0x1.e8eacae5d0f96p-55},
    {-0x1.0000000000000p+219, 0x1.e4ab51abbc80dp+226, -0x1.0e6f3895294d2p-8,
     -0x1.c9ce572b515a6p-63},
    {0x1.0000000000000p-10, 0x1.12bdfec0969d5p-8, 0x1.d4b6c8fbff944p-3, 0x1.6ed0ba7b5daeap-57},
    {0x1.0000000000000p-265, 0x1.707b3266f62dap-266, 0x1.e4da3cd014c9dp-1, -0x1.bb87d411fc596p-55},
    {0x1.0000000000000p-123, -0x1.c11fe62d17da5p-127, 0x1.ae151bce9d37fp+0, 0x1.cb00a8ecb1578p-54},
    {-0x1.0000000000000p+149, -0x1.e7d0617cf2171p+152, -0x1.89bd3e26bbee6p+1,
     -0x1.e3b9ee0d99bcap-53},
    {0x1.0000000000000p+233, 0x1.1dcb867c0f5f6p+241, 0x1.ca9edb52ce261p-9, -0x1.fd96f8e89e845p-64},
    {0x1.0000000000000p-270, 0x1.335695b1cfabfp-271, 0x1.07b9c4a5d2eebp+0, 0x1.816e48afa5cdcp-55},
    {-0x1.0000000000000p-126, -0x1.08579c99de269p-134, -0x1.93280c82e9a09p+0,
     0x1.1570e4d3013d2p-54},
    {-0x1.0000000000000p-96, 0x1.eed7145488638p-96, -0x1.e8e15ec802f6bp-2, -0x1.c94b225410194p-56},
    {0x1.0000000000000p+226, 0x1.30d255400fb66p+222, 0x1.7f1b893b0dfe5p+0, -0x1.71a67edc87dbap-54},
    {-0x1.0000000000000p-25, 0x1.c44e5a309a357p-22, -0x1.214dd4e865d37p-4, -0x1.538aa249b8234p-59},
    {-0x1.0000000000000p+224, 0x1.565b631d1e1f8p+231, -0x1.7ed8f4bd08921p-8,
     -0x1.bc449774b40f6p-64},
    {0x1.0000000000000p-243, -0x1.75e215ae55c44p-244, 0x1.19cbc4495ad02p+1, 0x1.a4c04ea9aad6ap-56},
    {0x1.0000000000000p+216, 0x1.e4eb5ac4fdff7p+213, 0x1.569ae50ea28cbp+0, -0x1.8bade2b4d79e8p-54},
    {0x1.0000000000000p+54, 0x1.06d6b634fd47bp+42, 0x1.920f47d8e5476p+0, 0x1.cba4b3987f8e9p-55},
    {-0x1.0000000000000p-272, -0x1.3d4ac4b8ade37p-265, -0x1.915129b654c27p+1,
     0x1.ddac6b5818497p-54},
    {0x1.0000000000000p-207, -0x1.1e87485de5c71p-200, 0x1.913afcd03f300p+1, 0x1.5cd2b4a390811p-53},
    {-0x1.0000000000000p-228, 0x1.ff27e320e97d0p-239, -0x1.91dfd049325a2p+0, 0x1.7e87465a8133fp-54},
    {0x1.0000000000000p-286, -0x1.1246c42cf880fp-280, 0x1.9041dbee791ebp+1, -0x1.8425a288f4c75p-53},
    {-0x1.0000000000000p-25, 0x1.8b8d8ebd34067p-35, -0x1.91bcd1e57ea6fp+0, -0x1.f526d8ff8e01cp-56},
    {-0x1.0000000000000p-3, 0x1.96dabf89bc1c9p-14, -0x1.91ecd9ecfcdfap+0, 0x1.d11e4d4a48266p-54},
    {0x1.0000000000000p+240, 0x1.cc79fa3cb2fdap+250, 0x1.1ca4ee79bc425p-11, -0x1.6db9092fcebd8p-66},
    {0x1.0000000000000p+165, 0x1.d19f0ded58639p+169, 0x1.19636fef5505fp-5, 0x1.c91f2924f807ep-59},
    {0x1.0000000000000p-184, 0x1.7b4f1bd494603p-196, 0x1.9208005296e17p+0, -0x1.e62c7781eff6dp-55},
    {0x1.0000000000000p+131, -0x1.1411093ff8fc3p+138, 0x1.913251f7e7723p+1, 0x1.6172b76ded586p-54},
    {-0x1.0000000000000p-41, 0x1.82da87a08ddafp-32, -0x1.52d0b71971547p-10, 0x1.109f307543216p-64},
    {0x1.0000000000000p-279, -0x1.53e6fd38b5de1p-286, 0x1.94c77d00e6d08p+0, -0x1.1689ffa4e2e11p-57},
    {-0x1.0000000000000p-264, 0x1.30dec5ac0eafcp-259, -0x1.add41e2182679p-6, 0x1.5c0dace47e01dp-61},
    {-0x1.0000000000000p+218, 0x1.3605355af2e59p+222, -0x1.a6690f0ab8053p-5, 0x1.19c2d6928575bp-60},
    {-0x1.0000000000000p-72, 0x1.7cf569494e907p-72, -0x1.2ef072c242066p-1, 0x1.0d6b4a1cd846bp-57},
    {0x1.0000000000000p+289, -0x1.371a9445d42e2p+296, 0x1.914d0dfb190fep+1, -0x1.8a4b8d374275bp-56},
    {-0x1.0000000000000p+5, -0x1.02ed39eabb511p-4, -0x1.92a12bd62ecbdp+0, -0x1.cd2c6bde8f1bap-55},
    {-0x1.0000000000000p+13, 0x1.9f232c0cccd5ap+2, -0x1.91ebd0df772a4p+0, -0x1.5867726a26b37p-54},
    {0x1.0000000000000p+5, 0x1.ce25dd6b650acp+10, 0x1.1b9625295d722p-6, -0x1.743f085da8f01p-61},
    {-0x1.0000000000000p-167, -0x1.26c9536a5c133p-179, -0x1.923221d971529p+0,
     -0x1.51a6e4c65eeb8p-54},
    {-0x1.0000000000000p+283, 0x1.0af4cfcec4d7ap+282, -0x1.1715cd5e0136ep+0,
     -0x1.7cd839e03ab1ap-54},
    {-0x1.0000000000000p-95, 0x1.40faf91626645p-99, -0x1.7e1a7f13a94d7p+0, 0x1.122cdb52f1a9dp-54},
    {0x1.0000000000000p-102, 0x1.c2d2be7933368p-103, 0x1.b29cb49e3e5cep-1, -0x1.6675aad469479p-55},
    {0x1.0000000000000p+216, 0x1.fe4c7714d197ep+215, 0x1.92f9d673706fdp-1, -0x1.e75978b154562p-60},
    {-0x1.0000000000000p-12, 0x1.59e7a70195e75p-24, -0x1.920a16c9dfe04p+0, -0x1.d39d6d13dfb64p-54},
    {0x1.0000000000000p+276, 0x1.b90da1618ff81p+282, 0x1.292be060e320fp-7, -0x1.a3d9a444ea3bap-65},
    {-0x1.0000000000000p-82, 0x1.510eb6eadfb02p-88, -0x1.8cdbab166191ap+0, -0x1.64157bf9a5a7fp-54},
    {0x1.0000000000000p+260, -0x1.30f1653562d23p+256, 0x1.a525cf8fc4293p+0, -0x1.651fcd5eb7155p-55},
    {-0x1.0000000000000p-234, -0x1.546b10d7f7cbfp-229, -0x1.8f1dc906ddb49p+1,
     0x1.1f1617cc443edp-54},
    {-0x1.0000000000000p-127, 0x1.ff076936fa7e0p-136, -0x1.912031e48067dp+0, 0x1.a4cf922bbc3bcp-56},
    {0x1.0000000000000p+40, 0x1.52f8353ef5954p+42, 0x1.7e2dc7d131fefp-3, -0x1.7906b9e21033dp-57},
    {0x1.0000000000000p+46, -0x1.1f62cc8e84286p+42, 0x1.a40e5c2524983p+0, 0x1.d283fa2bdc8f0p-56},
    {-0x1.0000000000000p+200, 0x1.30144849bb0f2p+191, -0x1.9187ab31fe2e6p+0, 0x1.79b7eda1211ecp-54},
    {0x1.0000000000000p-5, 0x1.0000000000000p+0, 0x1.ffd55bba97625p-6, -0x1.5ec431444912cp-60},
    {0x1.0000000000000p+0, -0x1.0000000000000p-5, 0x1.9a1f0ab32d2f1p+0, -0x1.36315b2796c7cp-55},
    {0x1.8000000000000p-4, 0x1.0000000000000p+0, 0x1.7ee182602f10fp-4, -0x1.cfb654c0c3d98p-58},
    {0x1.0000000000000p+0, -0x1.8000000000000p-4, 0x1.aa0dcd6a45c29p+0, 0x1.7acdfbca7305bp-55},
    {0x1.4000000000000p-3, 0x1.0000000000000p+0, 0x1.3d6eee8c6626cp-3, 0x1.61a3b0ce9281bp-57},
    {0x1.0000000000000p+0, -0x1.4000000000000p-3, 0x1.b9cd9315cf966p+0, -0x1.72d24d69cfdebp-55},
    {0x1.c000000000000p-3, 0x1.0000000000000p+0, 0x1.b90d7529260a2p-3, 0x1.17b10d2e0e5abp-61},
    {0x1.0000000000000p+0, -0x1.c000000000000p-3, 0x1.c94163e96792dp+0, -0x1.e36e3ab45e22ep-54},
    {0x1.2000000000000p-2, 0x1.0000000000000p+0, 0x1.18bf5a30bf178p-2, 0x1.30ca4748b1bf9p-57},
    {0x1.0000000000000p+0, -0x1.2000000000000p-2, 0x1.d84f8bd072976p+0, 0x1.407bac1a5bf86p-54},
    {0x1.6000000000000p-2, 0x1.0000000000000p+0, 0x1.530ad9951cd4ap-2, -0x1.2566480884082p-57},
    {0x1.0000000000000p+0, -0x1.6000000000000p-2, 0x1.e6e26ba98a06bp+0, -0x1.0a4a65cfcac09p-54},
    {0x1.a000000000000p-2, 0x1.0000000000000p+0, 0x1.8b24d394a1b25p-2, 0x1.b6d0ba3748fa8p-56},
    {0x1.0000000000000p+0, -0x1.a000000000000p-2, 0x1.f4e8ea296b3e2p+0, -0x1.77e96e40e800fp-54},
    {0x1.e000000000000p-2, 0x1.0000000000000p+0, 0x1.c0db4c94ec9f0p-2, -0x1.cc1ce70934c34p-56},
    {0x1.0000000000000p+0, -0x1.e000000000000p-2, 0x1.012b4434befcap+1, 0x1.4eb652ddf11f4p-55},
    {0x1.1000000000000p-1, 0x1.0000000000000p+0, 0x1.f40dd0b541418p-2, -0x1.a3992dc382a23p-57},
    {0x1.0000000000000p+0, -0x1.1000000000000p-1, 0x1.079194b8c990fp+1, 0x1.cbde7af1aad85p-55},
    {0x1.3000000000000p-1, 0x1.0000000000000p+0, 0x1.1255d9bfbd2a9p-1, -0x1.2bdaee1c0ee35p-58},
    {0x1.0000000000000p+0, -0x1.3000000000000p-1, 0x1.0da5511210b36p+1, 0x1.83d25a27c2692p-53},
    {0x1.5000000000000p-1, 0x1.0000000000000p+0, 0x1.2958e59308e31p-1, -0x1.09e73b0c6c087p-56},
    {0x1.0000000000000p+0, -0x1.5000000000000p-1, 0x1.13661406e3a18p+1, 0x1.6bf44a37155f3p-53},
    {0x1.7000000000000p-1, 0x1.0000000000000p+0, 0x1.3f13fb89e96f4p-1, 0x1.ecf8b492644f0p-56},
    {0x1.0000000000000p+0, -0x1.7000000000000p-1, 0x1.18d4d9849bc49p+1, 0x1.95a09055ded43p-54},
    {0x1.9000000000000p-1, 0x1.0000000000000p+0, 0x1.538f57b89061fp-1, -0x1.1bb74abda520cp-55},
    {0x1.0000000000000p+0, -0x1.9000000000000p-1, 0x1.1df3b09045814p+1, -0x1.7379422d8ccffp-54},
    {0x1.b000000000000p-1, 0x1.0000000000000p+0, 0x1.66d663923e087p-1, -0x1.6ea6febe8bbbap-56},
    {0x1.0000000000000p+0, -0x1.b000000000000p-1, 0x1.22c57386b0eaep+1, -0x1.41475c7e5d2e8p-54},
    {0x1.d000000000000p-1, 0x1.0000000000000p+0, 0x1.78f6bbd5d315ep-1, 0x1.406a089803740p-55},
    {0x1.0000000000000p+0, -0x1.d000000000000p-1, 0x1.274d8997962e4p+1, -0x1.22b44c415c42cp-53},
    {0x1.f000000000000p-1, 0x1.0000000000000p+0, 0x1.89ff5ff57f1f8p-1, -0x1.55b9a5e177a1bp-55},
    {0x1.0000000000000p+0, -0x1.f000000000000p-1, 0x1.2b8fb29f8130ap+1, 0x1.be16410227be5p-56},
};

static double ulp_of(double x)
{
    int exponent;
    frexp(x, &exponent);
    return ldexp(1.0, exponent < DBL_MIN_EXP ? DBL_MIN_EXP - DBL_MANT_DIG : exponent - 53);
}

static void angles_agree_with_multiprecision(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof reference / sizeof *reference; i++) {
        const double *row = reference[i];
        const double error = (imk_atan2(row[0], row[1]) - row[2]) - row[3];
        CHECK_BELOW(fabs(error) / ulp_of(row[2]), 0.52);
    }
}

/* Uniform in [0, 1): the high bits of a multiplicative congruential sequence [STEELE2022]. */
static double uniform(uint64_t *state)
{
    *state = *state * UINT64_C(0xd1342543de82ef95) + 1;
    return (double)(*state >> 11) * 0x1p-53;
}

static void angles_agree_with_long_double(void **state)
{
    (void)state;
    if (LDBL_MANT_DIG < 64)
        skip();
    uint64_t seed = 1;
    double worst = 0.0;
    for (int i = 0; i < 200000; i++) {
        const int spread = i % 4 == 0 ? 2 : i % 4 == 1 ? 20 : 600;
        const double x = ldexp(uniform(&seed) - 0.5, (int)((uniform(&seed) - 0.5) * spread));
        const double y = ldexp(uniform(&seed) - 0.5, (int)((uniform(&seed) - 0.5) * spread));
        const long double exact = atan2l((long double)y, (long double)x);
        const double error = (double)fabsl((long double)imk_atan2(y, x) - exact);
        worst = fmax(worst, error / ulp_of((double)exact));
    }
    /* 0.5 of the rounding, and what long double leaves, 2^-11 */
    CHECK_BELOW(worst, 0.52);
}

/* Annex F of the C standard. */
static void angles_on_the_axes(void **state)
{
    (void)state;
    const double pi = 3.14159265358979323846, infinity = (double)INFINITY;
    assert_true(imk_atan2(0.0, 0.0) == 0.0 && !signbit(imk_atan2(0.0, 0.0)));
    assert_true(imk_atan2(-0.0, 0.0) == 0.0 && signbit(imk_atan2(-0.0, 0.0)));
    assert_true(imk_atan2(0.0, -0.0) == pi && imk_atan2(-0.0, -0.0) == -pi);
    assert_true(imk_atan2(0.0, -1.0) == pi && imk_atan2(-0.0, -1.0) == -pi);
    assert_true(imk_atan2(0.0, 1.0) == 0.0 && signbit(imk_atan2(-0.0, 1.0)));
    assert_true(imk_atan2(1.0, 0.0) == pi / 2 && imk_atan2(-1.0, -0.0) == -pi / 2);
    assert_true(imk_atan2(2.0, infinity) == 0.0 && imk_atan2(2.0, -infinity) == pi);
    assert_true(imk_atan2(-2.0, -infinity) == -pi && signbit(imk_atan2(-2.0, infinity)));
    assert_true(imk_atan2(infinity, 3.0) == pi / 2 && imk_atan2(-infinity, -3.0) == -pi / 2);
    assert_true(imk_atan2(infinity, infinity) == pi / 4);
    assert_true(imk_atan2(-infinity, -infinity) == -3 * pi / 4);
    assert_true(isnan(imk_atan2((double)NAN, 1.0)) && isnan(imk_atan2(0.0, (double)NAN)));
    /* nothing is lost where the quotient leaves the range */
    assert_true(imk_atan2(0x1p-1074, 1.0) == 0x1p-1074 && imk_atan2(1.0, 0x1p-1074) == pi / 2);
    assert_true(imk_atan2(DBL_MAX, DBL_MIN) == pi / 2 && imk_atan2(DBL_MIN, -DBL_MAX) == pi);
    assert_true(imk_atan2(DBL_MAX, DBL_MAX) == pi / 4);
}

/* FNV-1a of the bits over a grid: the same with every compiler and machine. */
static void bits_are_fixed(void **state)
{
    (void)state;
    uint64_t hash = UINT64_C(0xcbf29ce484222325);
    for (int i = 0; i < 200; i++)
        for (int j = 0; j < 100; j++) {
            const double value = imk_atan2(0.37 * i - 31.1, 0.71 * j - 29.3);
            uint64_t bits;
            memcpy(&bits, &value, sizeof bits);
            for (int shift = 0; shift < 64; shift += 8)
                hash = (hash ^ (bits >> shift & 0xff)) * UINT64_C(0x100000001b3);
        }
    assert_int_equal(hash, UINT64_C(0xdf73e07b44826845));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(angles_agree_with_multiprecision),
        cmocka_unit_test(angles_agree_with_long_double),
        cmocka_unit_test(angles_on_the_axes),
        cmocka_unit_test(bits_are_fixed),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
