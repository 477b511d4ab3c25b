#!/bin/sh
# loose_scene.sh GLB NAME: writes the scene in pieces: NAME.gltf with NAME.bin and, for the grey walls' colour,
# NAME.png.
set -eu
glb=${1:?usage: loose_scene.sh GLB NAME} name=${2:?usage: loose_scene.sh GLB NAME}
base=${name##*/}
length=$(od -An -tu4 -j12 -N4 "$glb" | tr -d ' ')
tail -c +$((length + 29)) "$glb" >"$name.bin"
printf '\211PNG\r\n\032\n\0\0\0\rIHDR\0\0\0\001\0\0\0\001\b\0\0\0\0:~\233U\0\0\0\nIDATx\234ch\0\0\0\202\0\201w\315r\266\0\0\0\0IEND\256B`\202' >"$name.png"
tail -c +21 "$glb" | head -c "$length" |
  sed -e "s/\"buffers\":\[{/&\"uri\":\"$base.bin\",/" \
    -e "s/\"materials\":/\"images\":[{\"uri\":\"$base.png\"}],\"textures\":[{\"source\":0}],&/" \
    -e 's/"pbrMetallicRoughness":{/&"baseColorTexture":{"index":0},/' >"$name.gltf"
