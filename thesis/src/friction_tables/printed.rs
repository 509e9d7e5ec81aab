//! The figures as the thesis prints them, with what is wrong in them.

use friction_ident::Stage;
use friction_model::ModelName;

/// One number of a table.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Row {
    /// As the thesis writes it.
    pub symbol: &'static str,
    /// As parameter files write it.
    pub name: &'static str,
    /// The printed figure, with its digits (N m, rad, s).
    pub printed: &'static str,
    /// What is consistent where the printed figure is not.
    pub remark: &'static str,
}

/// One table.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Printed {
    /// Its number.
    pub number: &'static str,
    /// What it holds.
    pub title: &'static str,
    /// The model; of two models that share it the first.
    pub model: ModelName,
    /// The stage that it is of; none for the harmonised ones.
    pub stage: Option<Stage>,
    /// Its numbers.
    pub rows: &'static [Row],
    /// Mean squares of estimation and validation [(N m)^2].
    pub mean_squares: Option<(&'static str, &'static str)>,
}

const fn row(
    symbol: &'static str,
    name: &'static str,
    printed: &'static str,
    remark: &'static str,
) -> Row {
    Row { symbol, name, printed, remark }
}

/// All tables, in the thesis's order.
pub const PRINTED: &[Printed] = &[
    Printed {
        number: "4.2",
        title: "static parameters, constant velocity, proposed and LuGre",
        model: ModelName::Proposed,
        stage: Some(Stage::Static),
        rows: &[
            row("F_s", "f_s", "0.0994", ""),
            row("F_c", "f_c", "0.0929", ""),
            row("v_s", "v_s", "0.1407", ""),
            row("f_v", "f_v", "0.0603", "the later stages and the computed dampings use 0.0403"),
        ],
        mean_squares: Some(("3.7316e-5", "5.4988e-5")),
    },
    Printed {
        number: "4.3",
        title: "static parameters, constant velocity, GMS and Xiong",
        model: ModelName::Gms,
        stage: Some(Stage::Static),
        rows: &[
            row("F_s", "f_s", "0.1035", ""),
            row("F_c", "f_c", "0.0921", ""),
            row("v_s", "v_s", "0.1", ""),
            row("f_v", "f_v", "0.0584", ""),
            row(
                "lambda_1",
                "alpha[0]",
                "0.2841",
                "the four sum to 0.9864; consistent after division by that",
            ),
            row("lambda_2", "alpha[1]", "0.2341", ""),
            row("lambda_3", "alpha[2]", "0.2341", ""),
            row("lambda_4", "alpha[3]", "0.2341", ""),
        ],
        mean_squares: Some(("4.1394e-5", "6.8605e-5")),
    },
    Printed {
        number: "4.4",
        title: "pre-sliding, proposed",
        model: ModelName::Proposed,
        stage: Some(Stage::PreSliding),
        rows: &[row("F_s", "f_s", "0.0980", ""), row("Z_b", "z_b", "0.0060", "")],
        mean_squares: Some(("3.6074e-4", "8.9796e-4")),
    },
    Printed {
        number: "4.5",
        title: "pre-sliding, LuGre",
        model: ModelName::LuGre,
        stage: Some(Stage::PreSliding),
        rows: &[row("sigma_0", "sigma0", "16.4690", "")],
        mean_squares: Some(("3.8059e-4", "9.6759e-4")),
    },
    Printed {
        number: "4.6",
        title: "pre-sliding, GMS",
        model: ModelName::Gms,
        stage: Some(Stage::PreSliding),
        rows: &[
            row(
                "sigma_01",
                "sigma0[0]",
                "7.9605",
                "fitted without slip: only the sum, 16.469, was identified",
            ),
            row("sigma_02", "sigma0[1]", "4.8757", ""),
            row("sigma_03", "sigma0[2]", "2.6039", ""),
            row("sigma_04", "sigma0[3]", "1.0290", ""),
        ],
        mean_squares: Some(("3.8059e-4", "9.7548e-4")),
    },
    Printed {
        number: "4.7",
        title: "pre-sliding, Xiong",
        model: ModelName::Xiong,
        stage: Some(Stage::PreSliding),
        rows: &[
            row(
                "K_01",
                "k[0]",
                "10.9915",
                "fitted without slip: only the sum, 16.541, was identified",
            ),
            row("K_02", "k[1]", "2.7836", ""),
            row("K_03", "k[2]", "1.9866", ""),
            row("K_04", "k[3]", "0.7792", ""),
        ],
        mean_squares: Some(("3.8062e-4", "9.7153e-4")),
    },
    Printed {
        number: "4.8",
        title: "frictional lag, proposed",
        model: ModelName::Proposed,
        stage: Some(Stage::Lag),
        rows: &[
            row("F_s", "f_s", "0.0986", ""),
            row("F_c", "f_c", "0.0925", ""),
            row("v_s", "v_s", "0.1526", ""),
            row("f_v", "f_v", "0.0403", ""),
            row("tau", "tau", "0.0111", ""),
        ],
        mean_squares: Some(("8.3762e-6", "9.5132e-6")),
    },
    Printed {
        number: "4.9",
        title: "frictional lag, LuGre",
        model: ModelName::LuGre,
        stage: Some(Stage::Lag),
        rows: &[
            row("F_s", "f_s", "0.0994", ""),
            row("F_c", "f_c", "0.0929", ""),
            row("sigma_0", "sigma0", "15", ""),
            row("sigma_1", "sigma1", "0.1307", ""),
            row("v_s", "v_s", "0.1468", ""),
            row("f", "f_v", "0.0603", "the later stages and the computed dampings use 0.0403"),
        ],
        mean_squares: Some(("8.6065e-6", "10.091e-6")),
    },
    Printed {
        number: "4.10",
        title: "frictional lag, GMS",
        model: ModelName::Gms,
        stage: Some(Stage::Lag),
        rows: &[
            row("F_s", "f_s", "0.1647", "times the sum of the shares, 0.6: 0.0988"),
            row("F_c", "f_c", "0.1540", "times the sum of the shares, 0.6: 0.0924"),
            row("sigma_01", "sigma0[0]", "15", ""),
            row("sigma_02", "sigma0[1]", "15", ""),
            row("sigma_03", "sigma0[2]", "15", ""),
            row("sigma_04", "sigma0[3]", "15", ""),
            row("sigma_11", "sigma1[0]", "0.0686", ""),
            row("sigma_12", "sigma1[1]", "0.0686", ""),
            row("sigma_13", "sigma1[2]", "0.0686", ""),
            row("sigma_14", "sigma1[3]", "0.0686", ""),
            row("alpha_1", "alpha[0]", "0.1500", "0.25, so that they sum to one"),
            row("alpha_2", "alpha[1]", "0.1500", "0.25, so that they sum to one"),
            row("alpha_3", "alpha[2]", "0.1500", "0.25, so that they sum to one"),
            row("alpha_4", "alpha[3]", "0.1500", "0.25, so that they sum to one"),
            row("v_s", "v_s", "0.1536", ""),
            row("C", "c[0]", "0.6539", ""),
        ],
        mean_squares: Some(("8.6428e-6", "9.3469e-6")),
    },
    Printed {
        number: "4.11",
        title: "frictional lag, Xiong",
        model: ModelName::Xiong,
        stage: Some(Stage::Lag),
        rows: &[
            row("F_s", "f_s", "1.0057", "0.10057"),
            row("F_c", "f_c", "0.09237", ""),
            row("lambda_1", "lambda[0]", "0.2998", ""),
            row("lambda_2", "lambda[1]", "0.2998", ""),
            row("lambda_3", "lambda[2]", "0.2998", ""),
            row("lambda_4", "lambda[3]", "0.1005", ""),
            row("v_s", "v_s", "0.13121", ""),
            row("tau", "tau", "0.0124", ""),
        ],
        mean_squares: Some(("8.5868e-6", "10.087e-6")),
    },
    Printed {
        number: "4.13",
        title: "harmonised, proposed",
        model: ModelName::Proposed,
        stage: None,
        rows: &[
            row("F_s", "f_s", "0.0994", ""),
            row("F_c", "f_c", "0.0925", ""),
            row("v_s", "v_s", "0.1407", ""),
            row("sigma", "sigma", "0.2998", "eq. 4.37, corrected, gives 0.3213"),
            row("f_v", "f_v", "0.0403", ""),
            row("tau", "tau", "0.0011", "table 4.8 has 0.0111, the one that gives a visible lag"),
            row("Z_b", "z_b", "0.006", ""),
        ],
        mean_squares: None,
    },
    Printed {
        number: "4.14",
        title: "harmonised, LuGre",
        model: ModelName::LuGre,
        stage: None,
        rows: &[
            row("F_s", "f_s", "0.0994", ""),
            row("F_c", "f_c", "0.0929", ""),
            row("sigma_0", "sigma0", "16.4690", ""),
            row("sigma_1", "sigma1", "0.3213", "eq. 4.40, corrected, gives 0.2494"),
            row("v_s", "v_s", "0.1407", ""),
            row("f_v", "f_v", "0.0403", ""),
        ],
        mean_squares: None,
    },
    Printed {
        number: "4.15",
        title: "harmonised, GMS",
        model: ModelName::Gms,
        stage: None,
        rows: &[
            row("F_s", "f_s", "0.1035", ""),
            row("F_c", "f_c", "0.0921", ""),
            row("v_s", "v_s", "0.1", ""),
            row("f_v", "f_v", "0.0584", ""),
            row("alpha1", "alpha[0]", "0.2841", "divide by the sum, 0.9864"),
            row("alpha2", "alpha[1]", "0.2341", ""),
            row("alpha3", "alpha[2]", "0.2341", ""),
            row("alpha4", "alpha[3]", "0.2341", ""),
            row("sigma_01", "sigma0[0]", "7.9605", ""),
            row("sigma_02", "sigma0[1]", "4.8757", ""),
            row("sigma_03", "sigma0[2]", "2.6039", ""),
            row("sigma_04", "sigma0[3]", "1.0290", ""),
            row("sigma_11", "sigma1[0]", "0.1611", ""),
            row("sigma_12", "sigma1[1]", "0.1173", ""),
            row("sigma_13", "sigma1[2]", "0.0749", ""),
            row("sigma_14", "sigma1[3]", "0.0321", ""),
            row("C_1", "c[0]", "0.2998", ""),
            row("C_2", "c[1]", "0.2998", ""),
            row("C_3", "c[2]", "0.2998", ""),
            row("C_4", "c[3]", "0.2998", ""),
        ],
        mean_squares: None,
    },
    Printed {
        number: "4.16",
        title: "harmonised, Xiong",
        model: ModelName::Xiong,
        stage: None,
        rows: &[
            row("F_s", "f_s", "1.0057", "0.10057"),
            row("F_c", "f_c", "0.0924", ""),
            row("f_v", "f_v", "0.1005", "0.0403 to 0.0584"),
            row("v_s", "v_s", "0.13121", ""),
            row("tau", "tau", "0.0124", ""),
            row("lambda_1", "lambda[0]", "0.2998", "the fourth 0.1005, as in table 4.11"),
            row("lambda_2", "lambda[1]", "0.2998", ""),
            row("lambda_3", "lambda[2]", "0.2998", ""),
            row("lambda_4", "lambda[3]", "0.2005", ""),
            row("sigma_1", "sigma[0]", "0.1964", ""),
            row("sigma_2", "sigma[1]", "0.0788", ""),
            row("sigma_3", "sigma[2]", "0.0603", ""),
            row("sigma_4", "sigma[3]", "0.0227", ""),
            row("K_1", "k[0]", "10.9915", ""),
            row("K_2", "k[1]", "2.7836", ""),
            row("K_3", "k[2]", "1.9866", ""),
            row("K_4", "k[3]", "0.7792", ""),
        ],
        mean_squares: None,
    },
];
