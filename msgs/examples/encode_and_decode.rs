//! A message as it stands on the wire and in bags, and back.

use msgs::{
    RosMessage,
    cdr::{self, CdrError},
    friction_msgs::MotorVoltage,
    std_msgs::Header,
};

fn main() -> Result<(), CdrError> {
    let message = MotorVoltage { header: Header::at(1_500_000_000), voltage: 1.5 };
    let bytes = cdr::encode(&message)?;
    println!("{} bytes of type {}: {bytes:02x?}", bytes.len(), MotorVoltage::TYPE_HASH);
    let back: MotorVoltage = cdr::decode(&bytes)?;
    assert_eq!(back, message);
    // What is cut is refused.
    assert!(cdr::decode::<MotorVoltage>(&bytes[..10]).is_err());
    Ok(())
}

#[test]
fn it_runs() {
    main().unwrap();
}
