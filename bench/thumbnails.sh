#!/bin/sh
# thumbnails.sh [DOC]: the small pictures of README.md, cut from the large ones in DOC/figures that `make
# stages` and `make figures` draw. Needs ImageMagick's convert.
set -eu
figures=${1:-doc}/figures
# thumbnail NAME FILE WIDTHxHEIGHT+X+Y: that part of FILE, 240 pixels wide.
thumbnail() {
  convert "$figures/$2.png" -crop "$3" +repage -resize 240x -strip "$figures/thumbnail-$1.png"
}
thumbnail ffgraph stage-ffgraph 802x396+760+88
thumbnail mincut stage-mincut 802x396+760+88
thumbnail lightgrid stage-lightgrid 980x480+55+92
thumbnail portalfit stage-portalfit 748x380+34+92
thumbnail tdpt-render fig7-veach-ajar-tdpt 213x120+215+0
