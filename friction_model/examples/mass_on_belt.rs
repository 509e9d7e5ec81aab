//! A mass on a moving belt, held by a spring: it sticks, is carried along, tears loose and slips
//! back. The mass and the friction's own states are integrated by Runge-Kutta.

use friction_model::{Body, Drive, FrictionModel, LuGre, ModelError, rk4};

/// Speed of the belt \[m/s\].
const BELT: f64 = 0.1;

/// Stiffness of the spring \[N/m\].
const SPRING: f64 = 2.0;

fn main() -> Result<(), ModelError> {
    let friction = LuGre::chapter_3();

    // Seen from the belt, the spring's end moves backwards: `Body` is a mass of 1 kg under friction
    // and whatever else acts on it.
    let mut mass = Body::<_, 0>::new(friction, 1.0);
    let (mut slips, mut slipping) = (0, false);
    // Stiff bristles want short steps: see `rk4` for how short.
    for _ in 0..1_250_000 {
        mass.advance(2e-5, |at| Drive::from(-SPRING * (at.position + BELT * at.time)));
        let over_ground = mass.moment().velocity + BELT;
        // It comes back faster than the belt carries it forward.
        let slips_now = over_ground < -BELT;
        slips += u32::from(slips_now && !slipping);
        slipping = slips_now;
    }
    println!("{slips} slips in 25 s");
    assert_eq!(slips, 3);

    // Where the motion is given, the friction is integrated alone.
    let mut state = friction.rest();
    let mut force = 0.0;
    for _ in 0..20_000 {
        force = rk4::step(&friction, &mut state, [0.05; 3], 2e-5);
    }
    println!("{force:.4} N at 0.05 m/s");
    assert!((force - 1.0).abs() < 1e-6);
    Ok(())
}

#[test]
fn it_runs() -> Result<(), ModelError> {
    main()
}
