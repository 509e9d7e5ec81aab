//! The ROS 2 packages: launch files, parameter files, layouts, and every package.xml against
//! Cargo.toml. Python's part is in `tests/python/`.

use tests::python;

#[tests::needs(bag_tools)]
#[test]
fn launch_files_layouts_and_packages_agree_with_the_code() {
    let python = python::interpreter("bag_tools");
    python::pytest(
        std::process::Command::new("env"),
        &python,
        &tests::checkout().join("tests/python"),
        &["-p", "no:cacheprovider"],
    );
}
