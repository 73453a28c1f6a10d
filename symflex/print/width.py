"""Widths of type, in em of ten points, rounded up: enough to know that a line fits before it is typeset.

Every width is one of three: at ten points, in a script of that (seven points) and in a script of the script
(five). Letters are those of Computer Modern and of Latin Modern, whichever are wider, with their italic
corrections; letters stand as far apart as there, but never closer. They are from the metric files cmmi, cmr,
cmti, cmsy, cmex, lmmi, lmr and lmri of 10, 7 and 5 points (D. E. Knuth, Computer Modern Typefaces, 1986;
B. Jackowski and J. M. Nowacki, Latin Modern, 2009). Spaces are those of D. E. Knuth, The TeXbook, 1986,
chapter 18: four mu at a plus, five at an equals sign, none in scripts.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from string import digits, punctuation
from typing import Final


@dataclass(frozen=True, slots=True)
class Width:
    """How wide something is at the three sizes of mathematics [em of ten points]."""

    # text, script and tiny: at full size, as a script, and as a script of a script.
    text: float
    script: float
    tiny: float

    def __add__(self, other: Width) -> Width:
        return Width(self.text + other.text, self.script + other.script, self.tiny + other.tiny)

    def __mul__(self, times: float) -> Width:
        return Width(times * self.text, times * self.script, times * self.tiny)

    def beyond(self, other: Width) -> Width:
        """Return by how much it is wider than another, at least 0."""
        return Width(
            max(self.text - other.text, 0.0),
            max(self.script - other.script, 0.0),
            max(self.tiny - other.tiny, 0.0),
        )

    @property
    def raised(self) -> Width:
        """The width as a script, or of what stands in a fraction of a line of text."""
        return Width(self.script, self.tiny, self.tiny)


def total(widths: Iterable[Width]) -> Width:
    """Return the width of things side by side."""
    text = script = tiny = 0.0
    for width in widths:
        text += width.text
        script += width.script
        tiny += width.tiny
    return Width(text, script, tiny)


def always(em: float) -> Width:
    """Return a width that is the same at all sizes."""
    return Width(em, em, em)


def widest(*widths: Width) -> Width:
    """Return the largest width at each size."""
    return Width(max(w.text for w in widths), max(w.script for w in widths), max(w.tiny for w in widths))


EM_MM: Final = 10 * 25.4 / 72.27  # one em of a ten point font [mm]
SCRIPT: Final = 0.9  # width of a superscript in a table, in proportion to the full size
NOTHING: Final = always(0.0)
DIGIT_SIZES: Final = Width(0.501, 0.399, 0.341)
THIN_SIZES: Final = Width(0.167, 0.137, 0.117)
OPERATOR_SIZES: Final = Width(1.223, 0.626, 0.542)  # a plus or minus between its operands
RELATION_SIZES: Final = Width(1.334, 0.626, 0.542)
COMMA_SIZES: Final = Width(0.445, 0.238, 0.23)
CDOT_SIZES: Final = Width(0.723, 0.238, 0.23)
STAR_SIZES: Final = Width(0.946, 0.41, 0.369)
MINUS_SIZES: Final = Width(0.778, 0.626, 0.542)
SLASH_SIZES: Final = Width(0.501, 0.41, 0.369)
PRIME_SIZES: Final = Width(0.231, 0.23, 0.23)
SCRIPT_SPACE: Final = always(0.05)  # what follows a subscript or superscript
FRACTION_EDGES: Final = always(0.241)  # beside a fraction
FENCE_SIZES: Final = (Width(0.389, 0.313, 0.271), Width(0.278, 0.227, 0.202), Width(0.501, 0.41, 0.369))
r"""A parenthesis, bracket and brace."""
BIG_FENCES: Final = (0.459, 0.417, 0.584)  # the same after ``\big``
BIGGER_FENCES: Final = (0.598, 0.473, 0.667)  # the same after ``\Big``
TALL_FENCES: Final = tuple(always(em + 0.167) for em in (0.876, 0.667, 0.889))
r"""The same after ``\left``, however tall, with the space that sets off what it encloses."""
ROOT: Final = always(1.001)
TALL_ROOT: Final = always(1.056)
DIGIT: Final = DIGIT_SIZES.text
THIN: Final = THIN_SIZES.text
OPERATOR: Final = OPERATOR_SIZES.text
RELATION: Final = RELATION_SIZES.text
TIMES: Final = OPERATOR_SIZES.text
CDOT: Final = CDOT_SIZES.text
MINUS: Final = MINUS_SIZES.text
QUAD: Final = 1.0
SLASH: Final = SLASH_SIZES.text
WIDEST: Final = 1.2  # no character is wider; for those without an entry
_LETTERS: Final = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz"


def _table(keys: str | list[str], text: str, script: str, tiny: str) -> dict[str, Width]:
    columns = zip(keys, text.split(), script.split(), tiny.split(), strict=True)
    return {c: Width(int(a) / 1000, int(b) / 1000, int(d) / 1000) for c, a, b, d in columns}


@dataclass(frozen=True, slots=True)
class Alphabet:
    """Letters and digits of a font in mathematics."""

    widths: Mapping[str, Width]  # with italic correction
    apart: Mapping[str, str]  # after the letter that is the key, each of these stands further away
    kern: Width  # by so much

    def after(self, before: str, letter: str) -> Width:
        """Return the width that a letter adds after another one, or after none."""
        width = self.widths[letter]
        return width + self.kern if letter in self.apart.get(before, "") else width


def _numerals(em: float) -> dict[str, Width]:
    return dict.fromkeys(digits, DIGIT_SIZES * (em / DIGIT))


ITALIC: Final = Alphabet(  # math italic
    _table(
        _LETTERS,
        "751 809 787 856 796 782 787 913 519 651 921 681 1080 913 791 781 791 768 671 724 792 806 1084 907 "
        "803 755 529 430 433 521 466 598 513 577 345 470 553 319 879 601 485 504 483 479 469 362 573 521 "
        "743 572 527 510",
        "602 639 623 676 626 615 623 709 409 509 721 549 838 709 630 617 630 607 530 580 620 645 860 711 "
        "643 594 434 352 358 417 380 469 416 469 283 372 443 257 710 495 395 413 392 393 378 303 473 426 "
        "598 454 431 411",
        "519 542 533 573 530 521 533 593 352 435 604 478 697 593 542 525 542 516 454 503 527 553 727 595 "
        "552 506 388 317 325 370 339 402 369 414 267 324 388 241 615 441 352 370 348 354 336 282 424 380 "
        "518 396 384 363",
    )
    | _numerals(0.501),
    {"d": "Y"},
    Width(0.056, 0.044, 0.035),
)
UPRIGHT: Final = Alphabet(  # roman
    _table(
        _LETTERS,
        "751 709 723 764 681 653 785 751 362 514 778 626 917 751 778 681 778 760 556 723 751 764 1042 754 "
        "776 612 511 556 445 556 445 385 514 563 278 306 539 283 841 563 501 556 555 392 395 389 563 542 "
        "737 544 542 445",
        "591 560 571 603 538 517 619 591 289 409 612 495 720 591 614 538 614 592 442 571 591 602 817 591 "
        "610 485 401 442 356 442 356 304 410 442 227 248 421 227 657 442 399 442 427 313 317 313 442 431 "
        "582 422 431 356",
        "491 468 480 503 451 433 517 491 248 346 508 416 595 491 514 451 514 485 376 480 491 499 673 491 "
        "506 410 341 376 306 376 306 263 349 376 202 219 358 202 549 376 341 376 358 271 275 271 376 367 "
        "488 358 367 306",
    )
    | _numerals(0.501),
    {"I": "I", "a": "j", "g": "j"} | dict.fromkeys("bop", "ceodqj"),
    Width(0.056, 0.044, 0.035),
)
TEXT_ITALIC: Final = Alphabet(  # italic of running text, for words in mathematics
    _table(
        _LETTERS,
        "744 807 861 850 799 786 861 908 544 666 915 652 1061 908 861 781 861 769 682 849 908 927 1183 902 "
        "938 759 588 524 517 615 536 519 549 588 409 452 568 359 895 639 575 575 549 530 491 428 614 568 "
        "773 585 575 532",
        "607 645 686 681 634 624 686 710 428 519 726 520 834 710 691 625 691 615 542 676 710 736 942 716 "
        "745 604 483 423 416 488 433 411 442 483 320 358 457 282 730 524 464 464 442 426 395 344 504 457 "
        "621 467 462 430",
        "433 461 490 486 453 446 490 507 306 371 519 371 596 507 494 447 494 439 388 483 507 526 673 512 "
        "532 432 345 302 297 349 309 293 316 345 229 256 327 202 521 374 332 332 316 305 282 246 360 327 "
        "444 334 330 308",
    )
    | _numerals(0.512),
    dict.fromkeys("dlw", "l"),
    Width(0.052, 0.042, 0.03),
)
_ANY: Final = {c: widest(ITALIC.widths[c], UPRIGHT.widths[c], TEXT_ITALIC.widths[c]) for c in ITALIC.widths}
OTHER_ALPHABETS: Final = Alphabet(  # bold, sans serif and calligraphic letters
    {c: width * 1.2 for c, width in _ANY.items()}, {**UPRIGHT.apart, **TEXT_ITALIC.apart}, UPRIGHT.kern * 1.2
)
TYPEWRITER: Final = 0.53
_SIGNS: Final = {c: 0.78 for c in punctuation} | {c: 0.39 for c in "()[].,:;'!`-"} | {" ": 0.34}
ROMAN: Final = {c: width.text for c, width in UPRIGHT.widths.items()} | _SIGNS
"""Upright text and its signs at ten points."""
_GREEK: Final = _table(
    (
        "alpha beta gamma delta epsilon zeta eta theta iota kappa lambda mu nu xi pi rho sigma tau upsilon "
        "phi chi psi omega varepsilon vartheta varpi varrho varsigma varphi "
        "Gamma Delta Theta Lambda Xi Pi Sigma Upsilon Phi Psi Omega"
    ).split(),
    "644 619 574 483 406 512 533 498 354 577 584 603 558 484 606 518 608 551 577 596 626 688 659 467 592 "
    "856 518 443 655 626 834 778 695 667 751 723 778 723 778 723",
    "520 490 464 389 334 410 438 403 296 469 475 487 448 388 493 415 489 450 469 481 500 555 529 378 483 "
    "687 415 362 526 495 657 614 548 528 591 571 614 571 614 571",
    "457 422 409 344 307 360 390 356 275 414 421 425 392 343 434 364 426 399 414 421 433 484 462 338 428 "
    "590 364 326 460 416 549 514 456 445 491 480 514 480 514 480",
)


def greek_width(command: str) -> Width:
    """Return the width of a Greek letter."""
    return _GREEK[command]
