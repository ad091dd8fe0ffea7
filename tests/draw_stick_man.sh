#!/usr/bin/env bash
# Draws a waving stick man on the pose editor's canvas with the real pointer: path order, one stroke per bone,
# a few pixels of hand tremor. The editor's window has to be the focused one, 1600 x 900 at the screen's top left.
#
#   xvfb-run -s "-screen 0 1600x900x24" tests/draw_stick_man.sh target/release/examples/pose_editor OUT.png
#
# starts the editor, draws, saves a screenshot of the screen as OUT.png, and ends the editor.
set -euo pipefail
editor="$1"
out="$2"
settle="${3:-6}"

"$editor" &
pid=$!
trap 'kill "$pid" 2>/dev/null || true' EXIT
for _ in $(seq 120); do
  sleep 1
  xdotool search --name 'stick3d pose editor' >/dev/null 2>&1 && break
done
sleep "$settle"

# Joints in pixels of the screen; the man's right is on the left.
declare -A at=(
  [forehead]="373 200" [neck]="373 272" [abdomen]="370 452"
  [elbow_r]="280 232"  [hand_r]="262 126"
  [elbow_l]="446 372"  [hand_l]="470 470"
  [knee_r]="328 606"   [foot_r]="306 758"
  [knee_l]="420 600"   [foot_l]="452 752"
)

tremor() { echo $((RANDOM % 5 - 2)); }
RANDOM=7

stroke() {
  local from to steps=14 step
  read -r -a from <<<"${at[$1]}"
  read -r -a to <<<"${at[$2]}"
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

stroke forehead neck
stroke neck elbow_r
stroke elbow_r hand_r
stroke neck elbow_l
stroke elbow_l hand_l
stroke neck abdomen
stroke abdomen knee_r
stroke knee_r foot_r
stroke abdomen knee_l
stroke knee_l foot_l

sleep "$settle"
import -window root "$out"
