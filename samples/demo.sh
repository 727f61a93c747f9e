#!/usr/bin/env bash
# The demo: a gallery of twelve pictures (gallery.txt), every built-in scene as a picture, three of them compared in every representation,
# every outline method on one of them, and one page that leads to all of it.
#   demo.sh PROGRAM FOLDER
set -euo pipefail
html() { printf '%s' "$1" | sed 's/&/\&amp;/g; s/</\&lt;/g; s/"/\&quot;/g'; }
limn=$1
out=$2
compared=(ellipsoid machined_part teacup)
drawn=rook # by every method: it is a mesh, as some of them need, with flat faces, round ones and edges
mkdir -p "$out/methods" "$out/gallery"

echo "Drawing the gallery"
mapfile -t calls < <(grep -v '^#' "$(dirname "$0")/gallery.txt")
for call in "${calls[@]}"; do
  # The calls are as a reader would type them: the shell takes their quotes off.
  eval "set -- ${call//\$OUT/\$out}"
  shift
  "$limn" "$@" -q
done

echo "Drawing the built-in scenes"
mapfile -t scenes < <("$limn" list scenes --json | sed -n 's/^ *"name": "\(.*\)",\{0,1\}$/\1/p')
[ ${#scenes[@]} -gt 0 ] || { echo "demo: '$limn list scenes --json' named no scene" >&2; exit 1; }
for scene in "${scenes[@]}"; do
  "$limn" render "$scene" --size 640x480 -q -o "$out/$scene.png"
done
for scene in "${compared[@]}"; do
  echo
  echo "Comparing the representations of '$scene'"
  "$limn" compare "$scene" -o "$out/compare-$scene"
done
echo
echo "Drawing '$drawn' by every outline method"
# Entries are indented once, their parameters deeper.
mapfile -t methods < <("$limn" list methods --json | sed -n 's/^ \{2,4\}"name": "\(.*\)",\{0,1\}$/\1/p')
[ ${#methods[@]} -gt 0 ] || { echo "demo: '$limn list methods --json' named no method" >&2; exit 1; }
for method in "${methods[@]}"; do
  "$limn" render "$drawn" --method "$method" --size 480x480 --samples 4 --background 1,1,1 -q -o "$out/methods/$method.png"
done
"$limn" compare "$drawn" --methods all --size 960x720 -o "$out/compare-methods"

{
  cat <<'HTML'
<!doctype html><html lang="en"><meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1">
<title>limn: demo</title>
<style>
  :root { color-scheme: light dark; }
  body { font: 16px/1.5 system-ui, sans-serif; max-width: 72rem; margin: 2rem auto; padding: 0 1rem; }
  .grid { display: grid; grid-template-columns: repeat(auto-fill, minmax(16rem, 1fr)); gap: 1rem; }
  figure { margin: 0; } img { width: 100%; height: auto; background: #fff; border-radius: .4rem; }
  a { color: inherit; } code { font-size: .8rem; overflow-wrap: anywhere; }
</style>
<h1>The border of a surface, and how far to trust it</h1>
<p>The dark rim is drawn where the surface turns away from the eye. It depends on how the surface is modelled: a formula, a grid of
distances, or triangles. Each comparison below draws one shape in every representation and counts the pixels where the border is wrong.</p>
<h2>Gallery</h2><div class="grid">
HTML
  for call in "${calls[@]}"; do
    file=${call##*\$OUT/} shown=${call% -o *}
    printf '<figure><a href="%s"><img src="%s" alt="Picture by %s"></a><figcaption><code>%s -o %s</code></figcaption></figure>\n' \
      "$file" "$file" "$(html "$shown")" "$(html "$shown")" "${file##*/}"
  done
  echo '</div><h2>Comparisons</h2><div class="grid">'
  for scene in "${compared[@]}"; do
    printf '<figure><a href="compare-%s/report.html"><img src="%s.png" alt="%s">Compare: %s</a></figure>\n' "$scene" "$scene" "$scene" "${scene//_/ }"
  done
  echo '</div><h2>Outline methods</h2>'
  echo '<p><a href="compare-methods/report.html">All of them on every model of one shape, with what differs and what fails</a></p>'
  echo '<div class="grid">'
  for method in "${methods[@]}"; do
    printf '<figure><img src="methods/%s.png" alt="%s drawn by %s" loading="lazy"><figcaption>%s</figcaption></figure>\n' \
      "$method" "${drawn//_/ }" "$method" "$method"
  done
  echo '</div><h2>All scenes</h2><div class="grid">'
  for scene in "${scenes[@]}"; do
    printf '<figure><img src="%s.png" alt="%s" loading="lazy"><figcaption>%s</figcaption></figure>\n' "$scene" "$scene" "${scene//_/ }"
  done
  echo '</div></html>'
} > "$out/index.html"
echo
echo "Open $out/index.html"
