"""How a study's page calls models and drawings."""

RESOLUTIONS = ("level", "voxels", "voxel_size", "local")
# Order of the angle between a model's normals and the surface's: docs/reference.md and the theory in docs/accuracy.md.
NORMAL_ORDERS = {("mesh", "flat"): (1, 1), ("mesh", "vertex"): (1, 2), ("mesh", "limit"): (2, 2),
                 ("level_set", "cell"): (1, 1), ("level_set", "central"): (2, 2), ("level_set", "cubic"): (3, 3)}


def spaced(text):
    return text.replace("_", " ")


def setting_text(name, value):
    if name == "normals":
        return "flat facets" if value == "flat" else f"{spaced(value)} normals"
    if name == "gradient":
        return f"{spaced(value)} gradient"
    return spaced(value) if name == "scheme" else f"{spaced(name)} {value}"


def series_of(settings):
    others = [setting_text(name, value) for name, value in sorted(settings.items()) if name != "surface" and name not in RESOLUTIONS]
    return ", ".join([spaced(settings["surface"])] + others)


def resolution_text(settings):
    return ", ".join(f"{settings[name]} voxels" if name == "voxels" else f"{spaced(name)} {settings[name]}"
                     for name in RESOLUTIONS if name in settings)


def title_of(settings):
    return ", ".join(text for text in (series_of(settings), resolution_text(settings)) if text)


def drawings_of(cells):
    """Cell key -> what drew it: its method, the threshold, and what differs among the cells of the method."""
    seen = {}
    for cell in cells:
        for name, value in cell.parameters.items():
            seen.setdefault((cell.method, name), set()).add(value)
    return {cell.key: ", ".join([cell.method] + [f"{spaced(name)} {value}" for name, value in sorted(cell.parameters.items())
                                                 if name == "threshold" or len(seen[cell.method, name]) > 1]) for cell in cells}


def is_position(metric):
    """A place in the picture, which the page leaves out."""
    return metric.endswith(("_x", "_y"))


def is_distance(metric, unit):
    """Whether the metric says how far the border is from the true one."""
    return unit == "px" and ("displacement" in metric or metric.startswith("border_error"))


def expected_orders(settings, metric, unit, threshold):
    """The least and the greatest order that theory expects of a model's error, or None."""
    orders = NORMAL_ORDERS.get((settings["surface"], settings.get("normals") or settings.get("gradient")))
    if orders is None or "normal_error" in metric:
        return orders
    if not is_distance(metric, unit) or metric.endswith("_mean"):
        return None
    if "silhouette" in metric or threshold == 0.0:
        return (2, 2)
    return tuple(min(order, 2) for order in orders)
