import numpy as np
import pytest
from conftest import coulomb_viscous

from friction_analysis import BagError, read_bag
from friction_analysis.figures import FIGURES, command_parts, friction, main, stribeck_curve, thinned, tracking

PNG = b"\x89PNG\r\n\x1a\n"


def lines(ax):
    return {line.get_label(): line for line in ax.get_lines()}


def test_the_stribeck_curve_shows_the_friction_that_is_in_the_bag(known):
    figure = stribeck_curve(read_bag(known.plain), average=0.002)
    ax = figure.axes[0]
    drawn = [line for line in ax.get_lines() if line.get_color() == "#1f77b4"]
    velocity = np.concatenate([line.get_xdata() for line in drawn])
    torque = np.concatenate([line.get_ydata() for line in drawn])
    assert velocity.min() < -1.8 and velocity.max() > 1.8
    assert np.allclose(torque, coulomb_viscous(velocity), atol=1e-12), "linear on each side: means are exact"
    estimated = lines(ax)["estimated"]
    assert np.allclose(estimated.get_ydata(), coulomb_viscous(estimated.get_xdata()) - 0.01, atol=1e-12)


def test_tracking_shows_each_mode_by_itself_and_breaks_at_the_pause(known):
    figure = tracking(read_bag(known.plain))
    assert [ax.get_ylabel() for ax in figure.axes] == [
        "velocity [rad/s]",
        "error [rad/s]",
        "position [rad]",
        "error [rad]",
    ]
    assert "rms 0.5 rad/s, largest 0.5" in figure.axes[1].get_title()
    assert lines(figure.axes[2])["measured"].get_xdata().min() == pytest.approx(5.0)


def test_friction_and_its_estimate_differ_by_what_is_in_the_bag(known):
    figure = friction(read_bag(known.plain))
    difference = lines(figure.axes[1])["measured minus estimated"].get_ydata()
    assert np.allclose(difference[np.isfinite(difference)], 0.01, atol=1e-12)
    time = lines(figure.axes[0])["measured"].get_xdata()
    assert np.isnan(time).sum() == 1, "one pause"


def test_parts_of_the_command_that_are_zero_are_not_drawn(known):
    ax = command_parts(read_bag(known.plain)).axes[0]
    assert set(lines(ax)) == {"total", "linear", "friction"}


def test_thinning_keeps_extremes_and_gaps():
    time = np.arange(200_000) * 1e-3
    time[100_000:] += 5.0
    value = np.sin(time)
    value[54_321], value[150_001] = 7.0, -7.0
    t, v = thinned(time, value)
    assert len(t) < 5000
    assert np.nanmax(v) == 7.0 and np.nanmin(v) == -7.0
    assert np.isnan(t).sum() == 1
    assert t[0] == time[0] and t[-1] == time[-1]
    assert np.isin(t[np.isfinite(t)], time).all(), "points are samples, not means"


def test_the_command_draws_all_figures_beside_the_bag(known, capsys):
    assert main([str(known.plain)]) == 0
    for name in FIGURES:
        file = known.plain.parent / "figures" / f"{name}.png"
        assert file.read_bytes().startswith(PNG)
        assert str(file) in capsys.readouterr().out or name != "stribeck"


def test_the_command_takes_one_axis_one_figure_and_another_format(known, tmp_path):
    given = [str(known.named), "--namespace", "axis_1", "--figure", "tracking", "--format", "svg", "--out", str(tmp_path)]
    assert main(given) == 0
    assert [file.name for file in tmp_path.iterdir()] == ["tracking.svg"]
    assert "<svg" in (tmp_path / "tracking.svg").read_text(encoding="utf-8")


def test_what_cannot_be_drawn_is_told(known, tmp_path, capsys):
    assert main([str(known.named), "--out", str(tmp_path)]) == 2
    assert "/joint_states" in capsys.readouterr().err
    with pytest.raises(BagError, match="/controller_state"):
        tracking(read_bag(known.plain, ["/joint_states"]))
    with pytest.raises(SystemExit) as ended:
        main([str(known.plain), "--average", "-1"])
    assert ended.value.code == 2


def test_every_figure_of_the_laboratorys_own_bag_is_drawn(laboratory_bag, tmp_path):
    assert main([str(laboratory_bag), "--to", "5", "--out", str(tmp_path)]) == 0
    assert sorted(file.stem for file in tmp_path.iterdir()) == sorted(FIGURES)
    part = read_bag(laboratory_bag, ["/joint_states"], start_s=6.0, stop_s=14.0)
    points = [line for line in stribeck_curve(part).axes[0].get_lines() if line.get_marker() == "o"]
    velocity = np.concatenate([line.get_xdata() for line in points])
    torque = np.concatenate([line.get_ydata() for line in points])
    fast = np.abs(velocity) > 0.2
    assert fast.any()
    # The simulated test bed's steady friction above the Stribeck velocity: F_c = 0.0925 N m, F_v = 0.0403 N m s/rad.
    expected = np.sign(velocity) * 0.0925 + 0.0403 * velocity
    assert np.abs(torque - expected)[fast].max() < 0.01
