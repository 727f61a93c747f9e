"""How small an error can be told from none, and what that lets one say of an error against a tolerance."""
import dataclasses
import math

PRECISION_PX = 0.005
EXACT_PX = 0.1  # truth that may be further off is not called exact


def two_digits_up(value):
    """Rounded up to two digits, so that nothing below it is quoted."""
    unit = 10.0 ** (math.floor(math.log10(value)) - 1)
    return math.ceil(value / unit - 1e-9) * unit


def px_text(px):
    return f"{px:.0f} px" if px >= 99.5 else f"{px:.2g} px"


def bound_of(truth):
    """Of an entry of study.json's truths; infinite where nobody knows it."""
    return math.inf if truth["bound_px"] is None else float(truth["bound_px"])


def truths_of(record):
    """The truths of study.json that there are: of some borders there may be none."""
    return [truth for truth in record["truths"] if "failed" not in truth]


@dataclasses.dataclass
class Floor:
    reference_px: float  # what the reference itself scores, the worst of all cells
    bound_px: float  # how far off truth itself may be
    exact: bool

    @property
    def px(self):
        return max(PRECISION_PX, self.reference_px, self.bound_px)

    @property
    def doubt_px(self):
        return 0.0 if self.exact else self.bound_px

    def right(self, tolerance):
        """The largest error that is right to the tolerance, or None."""
        return tolerance - self.doubt_px if self.px <= tolerance else None

    def is_right(self, error, tolerance):
        right = self.right(tolerance)
        return right is not None and error <= right

    def is_wrong(self, error, tolerance):
        return error - self.doubt_px > tolerance

    def words(self, error):
        if error >= self.px or not math.isfinite(self.px):
            return px_text(error)
        return f"less than {px_text(two_digits_up(self.px))}"


def floor_of(cells, record, metric):
    """`cells`: of the whole study, those that failed too; `record`: study.json."""
    reference = max((abs(cell.floors.get(metric, 0.0)) for cell in cells), default=0.0)
    bounds = [cell.truth_bound_px for cell in cells if cell.truth and cell.values]
    if not record["exact"]:
        bounds += [bound_of(truth) for truth in truths_of(record)]
    return Floor(reference, max(bounds, default=0.0), record["exact"])
