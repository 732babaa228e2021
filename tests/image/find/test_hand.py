"""Objects that a hand holds, drawn."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from profiletool.errors import Unsure
from profiletool.image.find.hand import Hand, hand_at
from profiletool.image.find.hint import Hint
from profiletool.image.find.silhouette import find_silhouette
from profiletool.image.find.view import view_of
from profiletool.records.picture import Picture, Silhouette

SHAPE = HEIGHT, WIDTH = 300, 400
ROW, COLUMN = np.indices(SHAPE)
PALE, TAN, DARK = (236, 192, 170), (205, 150, 120), (96, 62, 46)
GREY, BLUE, WOOD = (150, 152, 150), (60, 90, 170), (178, 132, 86)
FREE = (140.0, 60.0, 120.0, 112.0)  # a box round what no finger covers
EGG = np.pi * 50.5 * 80.5  # pixels


class Scene:
    """A blue egg on a ground, and what is drawn over it."""

    def __init__(self, ground: tuple[int, ...] = GREY, colour: tuple[int, ...] = BLUE) -> None:
        self.rgb = np.ones((*SHAPE, 3)) * np.array(ground)
        cv2.ellipse(self.rgb, (200, 150), (50, 80), 0, 0, 360, colour, -1, cv2.LINE_AA)

    def arm(self, colour: tuple[int, ...], up_to: int = 215, wide: int = 50) -> Scene:
        cv2.line(self.rgb, (230, HEIGHT), (205, up_to), colour, wide, cv2.LINE_AA)
        return self

    def fingers(self, colour: tuple[int, ...]) -> Scene:
        for y in (180, 200):
            cv2.line(self.rgb, (150, y), (215, y), colour, 16, cv2.LINE_AA)
        return self

    def picture(self) -> Picture:
        blurred = cv2.GaussianBlur(self.rgb, (0, 0), 0.8)
        noise = np.random.default_rng(1).normal(0, 2, blurred.shape)
        rgb = np.clip(np.round(blurred + noise), 0, 255).astype(np.uint8)
        return Picture(rgb, None, None, "PNG")


def found(scene: Scene, hint: Hint | None = None) -> Silhouette:
    return find_silhouette(scene.picture(), hint=hint)


@pytest.mark.parametrize("tone", [PALE, TAN, DARK])
@pytest.mark.parametrize("ground", [GREY, (245, 244, 240), (60, 100, 80)])
def test_a_held_object_is_refused(tone: tuple[int, ...], ground: tuple[int, ...]) -> None:
    with pytest.raises(Unsure, match="a hand seems to hold") as refused:
        found(Scene(ground).arm(tone).fingers(tone))
    assert refused.value.candidates


def test_without_the_hand_it_is_found() -> None:
    assert found(Scene()).mask.sum() == pytest.approx(EGG, rel=0.005)


def test_a_hand_in_a_sleeve() -> None:
    held = Scene().arm((30, 40, 30), up_to=285, wide=60)
    cv2.circle(held.rgb, (212, 240), 32, TAN, -1)
    with pytest.raises(Unsure, match="a hand"):
        found(held)


def test_a_box_round_what_is_free() -> None:
    silhouette = found(Scene().arm(TAN).fingers(TAN), Hint(box=FREE))
    assert not silhouette.held
    egg = np.hypot((COLUMN - 200) / 50.5, (ROW - 150) / 80.5) <= 1.0
    assert silhouette.mask.sum() == pytest.approx(egg[:172].sum(), rel=0.05)
    assert not silhouette.mask[172:].any()


@pytest.mark.parametrize(
    "hint", [Hint(box=(130.0, 60.0, 140.0, 180.0)), Hint(point=(200.0, 120.0))]
)
def test_with_a_hint_it_is_told(hint: Hint) -> None:
    assert found(Scene().arm(TAN).fingers(TAN), hint).held
    assert not found(Scene(), hint).held


def test_a_mask_is_taken_at_its_word() -> None:
    whole = Scene().picture().rgb[..., 2] > 160
    assert found(Scene().arm(TAN).fingers(TAN), Hint(mask=whole)).method == "mask"


@pytest.mark.parametrize("ground", [GREY, WOOD])
def test_an_object_with_the_colour_of_skin_is_no_hand(ground: tuple[int, ...]) -> None:
    assert found(Scene(ground, TAN)).confidence > 0.5


def test_one_that_leaves_the_picture_is_no_hand() -> None:
    """A wooden handle and a forearm look alike: the frame's warnings deal with it."""
    handle = found(Scene(GREY, TAN).arm(TAN))
    assert handle.touches == {"bottom"}
    assert not handle.held


@pytest.mark.parametrize("rim", [BLUE, TAN])
def test_a_warm_shadow_is_no_hand(rim: tuple[int, ...]) -> None:
    scene = Scene((176, 172, 160), rim)
    cv2.ellipse(scene.rgb, (200, 150), (30, 60), 0, 0, 360, BLUE, -1, cv2.LINE_AA)
    shade = np.zeros(SHAPE)
    cv2.line(shade, (250, 340), (215, 170), 1.0, 70)
    shade = cv2.GaussianBlur(shade, (0, 0), 14)[..., None]
    egg = np.hypot((COLUMN - 200) / 50, (ROW - 150) / 80)[..., None] <= 1.0
    scene.rgb = np.where(egg, scene.rgb, scene.rgb * (1 - shade * (0.32, 0.42, 0.46)))
    assert found(scene).mask.sum() == pytest.approx(EGG, rel=0.02)


def test_a_wooden_lid_of_what_leaves_the_picture_is_no_hand() -> None:
    jar = Scene(GREY, TAN)
    cv2.rectangle(jar.rgb, (150, 140), (250, HEIGHT), BLUE, -1)
    assert found(jar).touches == {"bottom"}


def test_a_hand_that_hides_nothing() -> None:
    beside = Scene()
    cv2.line(beside.rgb, (400, 250), (330, 200), TAN, 60, cv2.LINE_AA)
    assert found(beside).mask.sum() == pytest.approx(EGG, rel=0.005)


def test_a_large_hand_among_many_things_holds_none_that_it_does_not_touch() -> None:
    paints = np.array([(30, 60, 200), (30, 170, 60), (20, 140, 150), (60, 60, 70)])
    squares = np.random.default_rng(3).integers(0, 4, (HEIGHT // 20, WIDTH // 20))
    ground = np.kron(paints[squares], np.ones((20, 20, 1)))
    rgb = ground.astype(np.uint8)
    egg = np.zeros(SHAPE, np.uint8)
    cv2.circle(egg, (150, 100), 40, 1, -1)
    cv2.line(rgb, (WIDTH, 250), (320, 200), TAN, 60)
    nowhere = np.zeros(SHAPE, bool)
    assert hand_at(view_of(rgb, nowhere), egg > 0) is Hand.NONE
    assert hand_at(view_of(ground.astype(np.uint8), nowhere), egg > 0) is Hand.NONE


def test_a_table_of_wood_is_no_hand() -> None:
    """Its colour comes in over three sides."""
    scene = Scene()
    scene.rgb[225:] = WOOD
    picture = scene.picture()
    egg = picture.rgb[..., 2] > 160
    assert hand_at(view_of(picture.rgb, np.zeros(SHAPE, bool)), egg) is Hand.NONE
