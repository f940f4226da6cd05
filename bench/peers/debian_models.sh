#!/bin/sh
# Textured models of Debian's assimp-testmodels as OBJ files with PNG and JPEG textures, into the folder $1, by Debian's
# assimp-utils and ffmpeg: a spider, Sony's rubber duck, a jeep, Cesium's milk truck. They are drawn, never passed on.
set -e
models=/usr/share/assimp/models
mkdir -p "$1"
cp $models/OBJ/spider.obj $models/OBJ/spider.mtl $models/OBJ/*.jpg "$1"
cp $models/MS3D/jeep1.jpg "$1"
cp $models/glTF/CesiumMilkTruck/CesiumMilkTruck.png "$1"
ffmpeg -v error -y -i $models/Collada/duckCM.tga "$1/duckCM.png"
assimp export $models/Collada/duck.dae "$1/duck.obj" -tri
assimp export $models/MS3D/jeep1.ms3d "$1/jeep.obj" -tri
assimp export $models/glTF/CesiumMilkTruck/CesiumMilkTruck.gltf "$1/truck.obj" -tri
sed -i s/duckCM.tga/duckCM.png/ "$1/duck.mtl"
