/* pair_formulas.h - the formulas between two particles, for numbers of the type REAL, named NAME(..). Included by
 * pair.h, once for double and once for float: one text, so that the fast form is the plain form in shorter numbers.
 * No include guard. F is kernel_slope. */

PAIR_INLINE REAL NAME(positive)(REAL a)
{
  return a > 0 ? a : 0;
}

PAIR_INLINE REAL NAME(cube)(REAL a)
{
  return a * a * a;
}

PAIR_INLINE REAL NAME(shape_value)(KernelKind kind, REAL q)
{
  if (kind == KERNEL_CUBIC_SPLINE) return NAME(cube)(NAME(positive)(2 - q)) - 4 * NAME(cube)(NAME(positive)(1 - q));
  if (kind == KERNEL_QUINTIC_SPLINE) {
    const REAL a = NAME(positive)(3 - q), b = NAME(positive)(2 - q), c = NAME(positive)(1 - q);
    return NAME(cube)(a) * a * a - 6 * NAME(cube)(b) * b * b + 15 * NAME(cube)(c) * c * c;
  }
  if (kind == KERNEL_LUCY) return (1 + 3 * q) * NAME(cube)(NAME(positive)(1 - q));
  const REAL s = NAME(positive)(1 - (REAL)0.5 * q);
  return NAME(cube)(s) * s * (2 * q + 1);
}

PAIR_INLINE REAL NAME(shape_slope)(KernelKind kind, REAL q)
{
  if (kind == KERNEL_CUBIC_SPLINE) {
    const REAL a = NAME(positive)(2 - q), b = NAME(positive)(1 - q);
    // near q = 0 the quotient is 12 - 9 q; the numerator is exactly that times q for q < 1
    return q < 1 ? 12 - 9 * q : (3 * a * a - 12 * b * b) / q;
  }
  if (kind == KERNEL_QUINTIC_SPLINE) {
    const REAL a = NAME(positive)(3 - q), b = NAME(positive)(2 - q);
    // for q < 1 the brackets' constant terms cancel: 5 a^4 - 30 b^4 + 75 c^4 = q (120 - 120 q^2 + 50 q^3)
    return q < 1 ? 120 - 120 * q * q + 50 * NAME(cube)(q) : (5 * a * NAME(cube)(a) - 30 * b * NAME(cube)(b)) / q;
  }
  if (kind == KERNEL_LUCY) {
    const REAL s = NAME(positive)(1 - q);
    return 12 * s * s;
  }
  return 5 * NAME(cube)(NAME(positive)(1 - (REAL)0.5 * q));
}

/* ---- d = x_i - x_j, u = v_i - v_j; volumes = V_i V_j, masses = m_i m_j ----
 * What one particle gains in mass by diffusion, in momentum and in heat the other loses: these are computed from
 * products that are symmetric in i and j to the last bit, but for one factor that changes sign. */

/* Continuity with density diffusion, V_i drho_i/dt = sum V_i V_j (-rho_i u.d + 2 delta h c0 (eta_j - eta_i)) F (eq. 13)
 * With volumes that do not grow beyond a torn melt's, the logarithm of the density changes by what the sum V_j W_ij
 * changes: it cannot become negative, and what is torn apart and joins again has the density that it had. */
PAIR_INLINE REAL NAME(pair_continuity)(REAL rho_i, REAL volumes, REAL u_dot_d, REAL F)
{
  return -rho_i * (volumes * F * u_dot_d);
}

PAIR_INLINE REAL NAME(pair_diffusion)(REAL volumes, REAL strength, REAL eta_i, REAL eta_j, REAL F)
{
  return volumes * F * (strength * (eta_j - eta_i));
}

/* Pressure: m_i dv_i/dt = d pair_pressure, with P = p/rho^2; -grad W = d F                                  (eq. 15) */
PAIR_INLINE REAL NAME(pair_pressure)(REAL masses, REAL P_i, REAL P_j, REAL artificial, REAL F)
{
  return masses * F * ((P_i + P_j) + artificial);
}

/* The same from a wall, which pushes and pulls at most with -least >= 0, for P_i + P_wall: a drop that was stretched a
 * little would be drawn into the wall by its own negative pressure. */
PAIR_INLINE REAL NAME(pair_wall_pressure)(REAL masses, REAL P_i, REAL P_wall, REAL least, REAL F)
{
  return masses * F * (NAME(positive)(P_i + P_wall - least) + least);
}

/* Artificial viscosity (Monaghan 1992): what is added to P_i + P_j where two particles approach, u.d < 0;
 * per_r2_plus = 1/(r^2 + 0.01 h^2),
 * strength = alpha c0 h/rho0 (the mean density replaced by rho0: within the 1 % of weak compressibility). */
PAIR_INLINE REAL NAME(pair_artificial)(REAL strength, REAL u_dot_d, REAL per_r2_plus)
{
  return strength * NAME(positive)(-u_dot_d) * per_r2_plus;
}

/* What keeps particles apart, added to P_i + P_j like pair_artificial: none beyond q = 1/per_q_apart, `strength` at q =
 * 0. Pressure knows the density and nothing of its evenness: in melt that is drawn out, particles line up along the
 * flow and close up across it, at the right density, until they all but coincide. A push at short range alone parts
 * them (the artificial pressure of Monaghan 2000, J. Comput. Phys. 159, whatever the sign of the pressure), conserves
 * momentum and derives from a potential. */
PAIR_INLINE REAL NAME(pair_apart)(REAL strength, REAL q, REAL per_q_apart)
{
  return strength * NAME(positive)(1 - q * per_q_apart);
}

/* Viscosity: m_i dv_i/dt = -u pair_viscosity; 4 mu mu/(mu + mu) keeps the stress continuous where mu jumps   (eq. 15)
 */
PAIR_INLINE REAL NAME(pair_viscosity)(REAL volumes, REAL mu_i, REAL mu_j, REAL per_mu_sum, REAL F)
{
  return volumes * F * (4 * (mu_i * mu_j) * per_mu_sum);
}

/* Heat from j to i, W                                                                                       (eq. 16) */
PAIR_INLINE REAL NAME(pair_heat)(REAL volumes, REAL kappa_i, REAL kappa_j, REAL per_kappa_sum, REAL T_i, REAL T_j,
                                 REAL F)
{
  return volumes * F * (4 * (kappa_i * kappa_j) * per_kappa_sum) * (T_j - T_i);
}
