import gtsam, numpy as np
p = gtsam.PreintegrationCombinedParams.MakeSharedU(9.81)
p.setGyroscopeCovariance(np.diag([1e-8, 4e-8, 9e-8]))
p.setAccelerometerCovariance(np.diag([1e-6, 4e-6, 9e-6]))
p.setBiasOmegaCovariance(np.diag([1e-12, 1e-12, 4e-12]))
p.setBiasAccCovariance(np.diag([1e-10, 1e-10, 1e-10]))
