//! Dormand, El-Mikkawy and Prince's method of order 8 with an error estimate of order 6.

use super::tableau::Tableau;
use crate::integrate::explicit::{Term, r, x};
use crate::integrate::{Control, SAFETY};

/// Nine stages, the last of which is the next step's first: eight evaluations a step, order 8; stable for hω ≤ 3.29.
///
/// Source: Dormand, El-Mikkawy and Prince, IMA J. Numer. Anal. 7 (1987) 423, RKN8(6).  Not theirs: the rows of the
/// dense output, whose places have errors O(h⁸) in the middle and O(h⁷) beside it, and the rows of the speeds, with errors O(h⁶).
/// Both solve the order conditions, which leave some of their entries free: those of the dense output make the errors of the next
/// order least, those of the speeds are the least.
pub(crate) const RKN8: Tableau = Tableau {
    order: 8,
    rows: &ROWS,
    places: PLACES,
    speeds: SPEEDS,
    errors: [PLACES_ERROR, SPEEDS_ERROR],
    // The difference is the error of the method of order 6.  With all of it tolerances of 1e-6 to 1e-10 leave errors 30 to 600
    // times smaller than those of `dop853`, for nearly as many evaluations; with a fifth they are some four times smaller at
    // 1e-4 and a hundred times at 1e-10; with a tenth an orbit may be lost at 1e-4.
    counts: 0.2,
    dense_rows: &DENSE_ROWS,
    speed_rows: &SPEED_ROWS,
    control: Control { exponent: 1.0 / 7.0, safety: SAFETY, shrink: 1.0 / 3.0, grow: 6.0, at_first: 6.0, stiff: 3.2 },
};

const ROWS: [(f64, &[Term]); 8] = [
    (0.0, &[]),
    (0.05, &[r(0, 1, 800)]),
    (0.1, &[r(0, 1, 600), r(1, 1, 300)]),
    (0.3, &[r(0, 9, 200), r(1, -9, 100), r(2, 9, 100)]),
    (0.5, &[r(0, -66701, 197352), r(1, 28325, 32892), r(2, -2665, 5482), r(3, 2170, 24669)]),
    (
        0.7,
        &[
            r(0, 227015747, 304251000),
            r(1, -54897451, 30425100),
            r(2, 12942349, 10141700),
            r(3, -9499, 304251),
            r(4, 539, 9250),
        ],
    ),
    (
        0.9,
        &[
            r(0, -1131891597, 901789000),
            r(1, 41964921, 12882700),
            r(2, -6663147, 3220675),
            r(3, 270954, 644135),
            r(4, -108, 5875),
            r(5, 114, 1645),
        ],
    ),
    (
        1.0,
        &[
            r(0, 13836959, 3667458),
            r(1, -17731450, 1833729),
            r(2, 1063919505, 156478208),
            r(3, -33213845, 39119552),
            r(4, 13335, 28544),
            r(5, -705, 14272),
            r(6, 1645, 57088),
        ],
    ),
];

/// bᵢ, also the row of the ninth stage.
const PLACES: &[Term] =
    &[r(0, 223, 7938), r(2, 1175, 8064), r(3, 925, 6048), r(4, 41, 448), r(5, 925, 14112), r(6, 1175, 72576)];

/// b'ᵢ.
const SPEEDS: &[Term] = &[
    r(0, 223, 7938),
    r(2, 5875, 36288),
    r(3, 4625, 21168),
    r(4, 41, 224),
    r(5, 4625, 21168),
    r(6, 5875, 36288),
    r(7, 223, 7938),
];

/// bᵢ less those of the embedded method of order 6.
const PLACES_ERROR: &[Term] = &[
    r(0, -544307, 12215700),
    r(2, 544307, 4963840),
    r(3, -544307, 3722880),
    r(4, 1632921, 12409600),
    r(5, -544307, 8686720),
    r(6, 544307, 44674560),
];

/// b'ᵢ less those of the embedded method of order 6.
const SPEEDS_ERROR: &[Term] = &[
    r(0, -544307, 12215700),
    r(2, 544307, 4467456),
    r(3, -544307, 2606016),
    r(4, 1632921, 6204800),
    r(5, -544307, 2606016),
    r(6, 544307, 4467456),
    r(7, 322012, 3053925),
    r(8, -3, 20),
];

const DENSE_ROWS: [(f64, &[Term]); 3] = [
    (
        0.3,
        &[
            x(0, 0.009118838000667002),
            x(2, 0.030258757686477615),
            x(3, 0.007492639927576279),
            x(4, -0.00317286922028387),
            x(5, 0.001990088993509229),
            x(6, -0.001071599557110827),
            x(7, -0.0010826410001292834),
            x(8, 0.0014667851692938573),
        ],
    ),
    (
        0.5,
        &[
            x(0, 0.01410690817344137),
            x(2, 0.06455107849675595),
            x(3, 0.044203300430353365),
            x(4, 0.0017815200291833337),
            x(5, 0.0005052656608900225),
            x(6, -0.00020862167961089055),
            x(7, -0.0003950747623952383),
            x(8, 0.00045562365138208634),
        ],
    ),
    (
        0.7,
        &[
            x(0, 0.0198547086369614),
            x(2, 0.09659934523234709),
            x(3, 0.08847519612720976),
            x(4, 0.03458208672422833),
            x(5, 0.006581676797295527),
            x(6, -0.0015896970309011078),
            x(7, 0.0005343600721438326),
            x(8, -3.767655928484307e-05),
        ],
    ),
];

const SPEED_ROWS: [&[Term]; 8] = [
    &[],
    &[],
    &[
        x(0, 0.042986500726377164),
        x(2, 0.06025101739479655),
        x(3, -0.0022606210703268997),
        x(4, -0.000962099142203425),
        x(5, -0.001556152778027452),
        x(6, 0.0031791377204471935),
        x(7, -0.00163778285106313),
    ],
    &[
        x(0, 0.023149069004156305),
        x(2, 0.17993302284852486),
        x(3, 0.10622371772219248),
        x(4, -0.003389098012738771),
        x(5, -0.013701339924194434),
        x(6, 0.013595590102642939),
        x(7, -0.005810961740583386),
    ],
    &[
        x(0, 0.016712223158576484),
        x(2, 0.18581392692654744),
        x(3, 0.20529275194864113),
        x(4, 0.0917208495947485),
        x(5, 0.01287521165757818),
        x(6, -0.02372672051165687),
        x(7, 0.011311757225565123),
    ],
    &[
        x(0, 0.034100887461316925),
        x(2, 0.14776442203250406),
        x(3, 0.23311592229568845),
        x(4, 0.18526005755798963),
        x(5, 0.11319086464930155),
        x(6, -0.01857301071337786),
        x(7, 0.005140856716577236),
    ],
    &[
        x(0, 0.029503217764167415),
        x(2, 0.15934159146681107),
        x(3, 0.21898093448875935),
        x(4, 0.18534020752001457),
        x(5, 0.2196854027810588),
        x(6, 0.1022697117924617),
        x(7, -0.015121065813272879),
    ],
    SPEEDS,
];
