"""The signs of the displays, by their pixels: sky is bluer than ground."""

import math
import time

import pytest

SKY, GROUND = "sky", "ground"
TAPE_PX, HEADING_PX = 72, 50


def kind(pixel) -> str:
    red, _, blue, _ = pixel
    return SKY if blue > red else GROUND


def pixels(page, places):
    """At parts of the attitude display, from its top left."""
    return page.evaluate(
        """([places, tape, heading]) => {
            const canvas = document.querySelector('.pfd-canvas');
            const ratio = canvas.width / canvas.clientWidth;
            const wide = canvas.clientWidth - 2 * tape, tall = canvas.clientHeight - heading;
            const context = canvas.getContext('2d');
            return places.map(([x, y]) => [...context.getImageData((tape + x * wide) * ratio, y * tall * ratio, 1, 1).data]);
        }""",
        [places, TAPE_PX, HEADING_PX],
    )


def posed(page, mock, **pose):
    mock.set(pose=pose)
    time.sleep(0.4)
    return page


@pytest.fixture
def fly(visit, mock):
    return visit("desktop", "dark").open("fly")


def test_level(fly, mock):
    posed(fly, mock, estimated_pitch_rad=0, estimated_roll_rad=0)
    above, below = pixels(fly, [(0.2, 0.4), (0.2, 0.6)])
    assert (kind(above), kind(below)) == (SKY, GROUND)


def test_nose_up_moves_the_horizon_down(fly, mock):
    """At 10° up, the middle of the display is sky; at 10° down, ground."""
    posed(fly, mock, estimated_pitch_rad=math.radians(10), estimated_roll_rad=0)
    middle, bottom = pixels(fly, [(0.06, 0.6), (0.06, 0.85)])
    assert (kind(middle), kind(bottom)) == (SKY, GROUND)
    posed(fly, mock, estimated_pitch_rad=math.radians(-10), estimated_roll_rad=0)
    top, middle = pixels(fly, [(0.06, 0.1), (0.06, 0.4)])
    assert (kind(top), kind(middle)) == (SKY, GROUND)


def test_right_wing_down_turns_the_horizon_counter_clockwise(fly, mock):
    """Banked to the right, the ground rises on the right side of the display."""
    posed(fly, mock, estimated_pitch_rad=0, estimated_roll_rad=math.radians(30))
    left, right = pixels(fly, [(0.06, 0.56), (0.94, 0.44)])
    assert (kind(left), kind(right)) == (SKY, GROUND)
    posed(fly, mock, estimated_pitch_rad=0, estimated_roll_rad=math.radians(-30))
    left, right = pixels(fly, [(0.06, 0.44), (0.94, 0.56)])
    assert (kind(left), kind(right)) == (GROUND, SKY)


def test_aircraft_points_to_its_heading(visit, mock):
    """Heading east, its nose is to the right of its tail, on the screen."""
    page = visit("desktop", "dark").open("fly")
    for degrees, ahead in [(0, (0, -1)), (90, (1, 0)), (180, (0, 1)), (270, (-1, 0))]:
        posed(
            page,
            mock,
            estimated_heading_rad=math.radians(degrees),
            estimated_north_mps=0,
            estimated_east_mps=0,
        )
        nose, tail = page.evaluate(
            """() => {
                const symbol = document.querySelector('.aircraft polygon');
                const on_screen = (x, y) => { const at = new DOMPoint(x, y).matrixTransform(symbol.getScreenCTM()); return [at.x, at.y]; };
                return [on_screen(0, -17), on_screen(0, 15)];
            }"""
        )
        assert [round((n - t) / 32) for n, t in zip(nose, tail, strict=False)] == list(ahead), (
            degrees
        )


def test_heading_is_named(fly, mock):
    posed(fly, mock, estimated_heading_rad=math.radians(90), heading_rad=math.radians(90))
    time.sleep(2.2)
    posed(fly, mock, estimated_heading_rad=math.radians(90.1))
    assert "heading 090°" in fly.locator(".pfd-canvas").get_attribute("aria-label")
