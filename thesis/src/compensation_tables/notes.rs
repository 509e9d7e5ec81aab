//! What of each table can be reproduced, what cannot, and why.

/// The notes of the table of that number.
pub(super) const fn of(number: &str) -> &'static str {
    match number.as_bytes() {
        b"5.1" => {
            "Mean over 8 noise seeds; J = 1 kg m² and a noise held for 0.5 s are inferred, the thesis states neither. The two rows without an observer agree. \
             The observer rows cannot be had on one plant: with the proposed model as plant and no error injection its own observer cancels the friction exactly and \
             gives the row without friction, LuGre comes next, and the observers over GMS and Xiong with the printed stiffness of 100 and 10 N m/rad, a fifth and a fiftieth \
             of the plant's 518, are worse than none. The printed rows come out within 7 % if every observer has a plant of its own model and an injection of k = 0.035. What injection \
             adds to the estimate is then proportional gain, P + sigma k: the order of the table is that of sigma (60, 20, 0.006, 6) and says \
             nothing of the models."
        }
        b"5.2" => {
            "J = 0.0023 kg m² is inferred. Printed as PI, it is the PID of the text. The printed ratio of the first two rows, 6.6, is met at 20 s, the printed row without friction at \
             50 s; no length meets both. The observer rows are not reproducible beyond their order of magnitude: without injection the proposed observer gives the row without friction, \
             LuGre comes next, and the soft GMS and Xiong make the loop oscillate by 2 rad; no single k fits the printed rows."
        }
        b"6.2" | b"6.3" | b"6.4" => {
            "Measured on the real rig, with observers of Table 6.1, filtered signals, and references that are not printed: it cannot be reproduced by simulation. Ours is the \
             simulated rig with the proposed model's friction as a torque, sensor noise and converter steps, five repetitions, errors of the shaft itself, inverse off, and observers \
             with the parameters of Tables 4.13 to 4.16. By mean square its observers gain more over the linear controller than the real ones did, 3 to 17 times against 1.02 to 2: they come from the plant, or from a model fitted to the same data. Improvements are of the largest error."
        }
        b"6.5" => {
            "r = 0.30 sin(0.107 t) rad/s over one period with B(s) off is inferred from the printed largest errors, which agree within 15 %; the amplitude and frequency trade off against \
             each other by 30 %. The linear controller's mean square error does not follow (1.96 to the printed 1.27). With B(s) on, as the text says, exact compensation \
             leaves no error at all, so the printed second row rules it out. The improvement is of the largest error."
        }
        b"6.6" => {
            "A step to 1 rad/s, 36 s, with the gain of B(s) on: without it the lag compensator alone leaves 1.0012e-4, more than the printed second row. The thesis says the opposite. Mean squares are by the \
             trapezoidal rule; the plain mean of samples adds the first error of 1 rad/s and depends on their spacing (1.12 and 1.01 at 1 ms). Ours samples at 5 kHz, near the continuous controller; at 1 kHz the held voltage takes 5 % off both rows. The improvement is of the mean square."
        }
        b"6.7" => {
            "r = 1.0 sin(0.546 t) rad, 20 s, B(s) off, K_d = +0.0768 (the text prints a minus). All four figures agree within 15 %. The improvement is of the largest error."
        }
        _ => "",
    }
}
