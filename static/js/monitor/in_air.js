/** Whether a UAV is in the air, by what it told and by what its link knows: true, false, or null where nobody has said. */

/** A flight that was told to be over is, though no report has said so. */
export const inAir = ({ measured, link }) => (link?.is_in_air === false ? false : (measured?.is_in_air ?? link?.is_in_air ?? null));
