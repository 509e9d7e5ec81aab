//! Models and their parameters from and to a file, chosen by name while the program runs.

use std::error::Error;

use friction_model::presets::Presets;
use friction_model::{AnyModel, LuGre, LuGreParameters, ModelName, TimeStep};

fn main() -> Result<(), Box<dyn Error>> {
    // A model whose type is known is its parameters. What may be left out is left out.
    let stiffer = LuGreParameters { sigma0: 30.0, ..LuGreParameters::test_bed() };
    let text = serde_json::to_string_pretty(&LuGre::try_from(stiffer)?)?;
    println!("{text}");
    assert_eq!(serde_json::from_str::<LuGre>(&text)?, LuGre::try_from(stiffer)?);

    // One that a file chooses stands under its name.
    let chosen: AnyModel = serde_json::from_str(r#"{ "coulomb": { "f_c": 0.09 } }"#)?;
    assert_eq!(chosen.name(), ModelName::Coulomb);
    let mut contact = chosen.start(TimeStep::new(1e-3)?);
    println!("{}: {} N m", contact.name(), contact.step(0.2));

    // Every model knows what its parameters mean.
    for row in chosen.parameters().table() {
        println!("{}: {}", row.name, row.meaning);
    }

    // What no contact can have is refused where it is read, with the reason.
    let refused = serde_json::from_str::<AnyModel>(r#"{ "coulomb": { "f_c": -0.09 } }"#);
    let message = refused.unwrap_err().to_string();
    println!("{message}");
    assert!(message.contains("coulomb.f_c must be a finite number above zero"));
    Ok(())
}

#[test]
fn it_runs() -> Result<(), Box<dyn Error>> {
    main()
}
