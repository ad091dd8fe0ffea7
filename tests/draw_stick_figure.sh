#!/usr/bin/env bash
# Draws a sketch on the pose editor's canvas with the real pointer, one stroke per bone, with a few pixels of hand tremor:
# along the sketch path or, with ORDER=any, in a shuffled order. Then saves it from the editor, and fails unless every joint
# was read where it was drawn. In any order nothing tells left from right but a rule, so pairs may be exchanged then.
#
#   xvfb-run -s "-screen 0 1600x900x24" \
#     tests/draw_stick_figure.sh target/release/examples/pose_editor assets/sketches/horse_walk.json [OUT.png]
#
# starts the editor with the sketch's figure, draws, takes a picture of the screen as OUT.png (needs ImageMagick), and
# ends the editor. AIM=8 lets strokes begin and end up to so many pixels beside their joints, and SAVE=FILE.json keeps what
# the editor saved. Its window has to be the focused one, 1600 x 900 at the screen's top left.
set -euo pipefail
editor="$(realpath "$1")"
sketch="$(realpath "$2")"
out="${3:+$(realpath "$3")}"
kept="${SAVE:+$(realpath "$SAVE")}"
aim="${AIM:-0}"
figures="$(realpath "$(dirname "$0")/../crates/stick3d_figure/figures")"
name="$(sed -n 's/.*"figure": *"\([a-z_]*\)".*/\1/p' "$sketch")"
work="$(mktemp -d)"
pid=""
trap '[ -z "$pid" ] || kill "$pid" 2>/dev/null || true; rm -rf "$work"' EXIT

# "joint x y" of a sketch file that has a joint a line.
joints() { sed -n 's/^ *"\([a-z_]*\)": *\[ *\([-0-9.e]*\), *\([-0-9.e]*\) *\].*/\1 \2 \3/p' "$1"; }

# The middle of the canvas and the room for the drawing, pixels of the screen.
centre=(373 489)
room=(520 540)
# Canvas units per pixel, and the middle of the canvas.
unit_per_px=1.4493
origin=(373 489)

joints "$sketch" | awk -v cx="${centre[0]}" -v cy="${centre[1]}" -v w="${room[0]}" -v h="${room[1]}" '
  { name[NR] = $1; x[NR] = $2; y[NR] = $3
    if (NR == 1 || $2 < x0) x0 = $2; if (NR == 1 || $2 > x1) x1 = $2
    if (NR == 1 || $3 < y0) y0 = $3; if (NR == 1 || $3 > y1) y1 = $3 }
  END {
    scale = h / (y1 - y0); if (w / (x1 - x0) < scale) scale = w / (x1 - x0)
    for (i = 1; i <= NR; i++)
      printf "%s %.0f %.0f\n", name[i], cx + (x[i] - (x0 + x1) / 2) * scale, cy - (y[i] - (y0 + y1) / 2) * scale
  }' >"$work/places"
declare -A at
while read -r joint x y; do at[$joint]="$x $y"; done <"$work/places"
test "${#at[@]}" -gt 2

cd "$work"
order="${ORDER:-guided}"
"$editor" --figure "$name" --size 1600x900 --order "$order" &
pid=$!
for _ in $(seq 120); do
  sleep 1
  xdotool search --name 'stick3d pose editor' >/dev/null 2>&1 && break
done
sleep 6

RANDOM=7
tremor() { echo $((RANDOM % 5 - 2)); }
beside() { echo $((RANDOM % (2 * aim + 1) - aim)); }
stroke() {
  local from to steps=14 step
  read -r -a from <<<"${at[$1]}"
  read -r -a to <<<"${at[$2]}"
  from=($((from[0] + $(beside))) $((from[1] + $(beside))))
  to=($((to[0] + $(beside))) $((to[1] + $(beside))))
  xdotool mousemove $((from[0] + $(tremor))) $((from[1] + $(tremor))) mousedown 1
  for step in $(seq "$steps"); do
    xdotool mousemove \
      $((from[0] + (to[0] - from[0]) * step / steps + $(tremor))) \
      $((from[1] + (to[1] - from[1]) * step / steps + $(tremor)))
    sleep 0.02
  done
  xdotool mouseup 1
  sleep 0.15
}

# Every bone of the path once, in its order or another.
declare -A listed
before=""
bones=()
for joint in $(sed -n '/^ *path: *\[/,/\]/p' "$figures/$name.ron" | grep -o '"[a-z_]*"' | tr -d '"'); do
  if [ -n "$before" ] && [ -z "${listed[$before-$joint]:-}" ] && [ -z "${listed[$joint-$before]:-}" ]; then
    bones+=("$before $joint")
    listed[$before-$joint]=1
  fi
  before="$joint"
done
if [ "$order" = any ]; then
  mapfile -t bones < <(printf '%s\n' "${bones[@]}" | shuf --random-source=<(yes 7))
fi
for bone in "${bones[@]}"; do
  read -r -a ends <<<"$bone"
  stroke "${ends[@]}"
done

# Where there is no window manager nobody has given the window the keyboard.
xdotool windowfocus "$(xdotool search --name 'stick3d pose editor' | tail -n 1)"
# Without a graphics card the editor may be some frames behind the pointer; keys have to last longer than one.
for _ in $(seq 15); do
  sleep 2
  xdotool keydown ctrl
  sleep 1
  xdotool key s
  sleep 1
  xdotool keyup ctrl
  [ ! -s "${name}_sketch.json" ] || break
done
test -s "${name}_sketch.json" || { echo "the figure was not complete, and could not be saved"; exit 1; }
xdotool mousemove 1200 60
sleep 5
[ -z "$out" ] || import -window root "$out"
[ -z "$kept" ] || cp "${name}_sketch.json" "$kept"

joints "${name}_sketch.json" | sort >read
awk -v u="$unit_per_px" -v ox="${origin[0]}" -v oy="${origin[1]}" -v order="$order" '
  function distance(joint, px, py) {
    if (!(joint in x)) return 1e9
    return sqrt(((px - ox) * u - x[joint]) ^ 2 + ((oy - py) * u - y[joint]) ^ 2)
  }
  function mirror(joint) {
    if (joint ~ /_.?r$/) return substr(joint, 1, length(joint) - 1) "l"
    if (joint ~ /_.?l$/) return substr(joint, 1, length(joint) - 1) "r"
    return joint
  }
  NR == FNR { x[$1] = $2; y[$1] = $3; next }
  { off = distance($1, $2, $3); joints++
    if (order == "any" && off > 25) off = distance(mirror($1), $2, $3)
    if (off > 25) { printf "%s was read %.0f units from where it was drawn\n", $1, off; bad = 1 } }
  END { if (bad || joints == 0) exit 1; printf "all %d joints were read where they were drawn\n", joints }' read places
