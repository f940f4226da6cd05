// The system of [Levoy95] on our rasterizer and codecs: the public face of sim/.
#pragma once

#include "sim/client.h"
#include "sim/difference.h"
#include "sim/experiment.h"
#include "sim/json.h"
#include "sim/loaded_scene.h"
#include "sim/match.h"
#include "sim/packet.h"
#include "sim/paper_figures.h"
#include "sim/rate_curve.h"
#include "sim/scenes.h"
#include "sim/screen_model.h"
#include "sim/server.h"
#include "sim/split.h"
#include "sim/table1.h"
