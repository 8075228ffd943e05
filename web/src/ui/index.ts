// What the viewer computes without a page, for tests in Node.
export { upOf } from "../render/upright";
export { axisOf, placeOf } from "../render/axis_ticks";
export { Extent } from "../render/extent";
export { particleSurface } from "../render/fields/particle_surface";
export { arrows, levelLine } from "../render/plane_lines";
export { infoOf } from "../render/scene_info";
export { scaleLabel } from "../render/scale_label";
export { evenStreamlines, streamline } from "../render/fields/streamlines";
export * as colorStops from "../render/fields/color_stops";
export { packScene, readAddress, unpackScene, writeAddress } from "./address/address";
export { chapterOf, matches } from "./gallery";
export { chooseAtFirst, endsOf, gapsIn, relative, scaleOf } from "./plot_model";
export { fieldsOf } from "./fields";
export { Past } from "./past";
export { triangleValues } from "../render/fields/element_values";
export { JointValues, jointValues } from "../render/fields/joint_values";
export { speedAtFirst, speedsFor } from "./speeds";
